// SPDX-License-Identifier: MIT
// Motions as translation, rotation and scale, in double precision.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kelp::bake {

// The rotation R that makes the sum of y . R x greatest, where `h` is the sum of y x^T (Horn 1987). The
// identity for zero.
glm::dmat3 nearestRotation(const glm::dmat3& h);

// Its unit quaternion.
glm::dquat quaternionOf(const glm::dmat3& rotation);

// The rotation of any quaternion but zero.
glm::dmat3 rotationOf(const glm::dquat& q);

inline glm::dmat3 linearOf(const glm::dmat4x3& m) { return {m[0], m[1], m[2]}; }

// posed = translation + rotation (scale x).
struct Trs {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};

  glm::dmat4x3 matrix() const {
    const glm::dmat3 turn = rotationOf(rotation);
    return {scale.x * turn[0], scale.y * turn[1], scale.z * turn[2], translation};
  }
};

// The nearest to `m`. Which axes are mirrored: those with which the rotation is nearest to `before`, which
// axes without length keep; absent: none, or x.
Trs nearestTrs(const glm::dmat4x3& m, const std::optional<glm::dquat>& before = std::nullopt);

// As the runtime interpolates keys, which need not be quite unit: spherical, the shorter way; then unit.
glm::dquat slerpShort(const glm::dquat& a, glm::dquat b, double share);

}  // namespace kelp::bake

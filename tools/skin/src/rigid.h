// SPDX-License-Identifier: MIT
// Rigid motions in double precision: a rotation and a translation in a 4x3 matrix. Those of parts whose
// joints scale also have one scale for all directions.
#pragma once

#include <array>
#include <cmath>

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

inline glm::dmat4x3 rigid(const glm::dmat3& rotation, const glm::dvec3& translation) {
  return {rotation[0], rotation[1], rotation[2], translation};
}

inline glm::dmat4x3 inverseRigid(const glm::dmat4x3& m) {
  const glm::dmat3 back = glm::transpose(linearOf(m));
  return rigid(back, -(back * m[3]));
}

// The scale of a rigid motion that has one: the cube root of the volume of a unit cube.
inline double scaleOf(const glm::dmat4x3& m) { return std::cbrt(std::abs(glm::determinant(linearOf(m)))); }
// Scales nearer to 1 are 1.
inline constexpr double kSameSize = 0.01;
// True for a motion whose scale differs from 1 by no more.
inline bool keepsSize(const glm::dmat4x3& m, double most = kSameSize) {
  return std::abs(scaleOf(m) - 1) <= most;
}

inline glm::dmat4x3 compose(const glm::dmat4x3& a, const glm::dmat4x3& b) {
  const glm::dmat3 turn = linearOf(a);
  return rigid(turn * linearOf(b), turn * b[3] + a[3]);
}

// Spherical between unit quaternions, the shorter way, as the runtime interpolates keys.
glm::dquat slerpShort(const glm::dquat& a, glm::dquat b, double share);

}  // namespace kelp::bake

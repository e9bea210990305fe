// SPDX-License-Identifier: MIT
// Geometric types that every library of kelp shares.
#pragma once

#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace kelp {

// With forced alignment in GLM, a host and kelp's libraries would disagree about the layout of every struct.
static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::mat4) == 64,
              "kelp needs GLM without GLM_FORCE_DEFAULT_ALIGNED_GENTYPES");

// An axis-aligned box. Empty when min > max on any axis (the default).
struct Box {
  glm::vec3 min{1e30f};
  glm::vec3 max{-1e30f};

  bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
  void add(const glm::vec3& p) {
    min = glm::vec3(p.x < min.x ? p.x : min.x, p.y < min.y ? p.y : min.y, p.z < min.z ? p.z : min.z);
    max = glm::vec3(p.x > max.x ? p.x : max.x, p.y > max.y ? p.y : max.y, p.z > max.z ? p.z : max.z);
  }
};

// The bounds of the eight transformed corners of `box`. Empty for an empty box.
Box transformed(const glm::mat4& matrix, const Box& box);

}  // namespace kelp

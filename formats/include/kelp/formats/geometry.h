// SPDX-License-Identifier: MIT
// The few geometric types that everything shares.
#pragma once

#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace kelp {

// A host that compiles GLM with forced alignment would disagree with kelp's libraries about every struct: refuse at compile time.
static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::mat4) == 64, "kelp needs GLM without GLM_FORCE_DEFAULT_ALIGNED_GENTYPES");

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

// The box around the eight transformed corners of `box`.
Box transformed(const glm::mat4& matrix, const Box& box);

}  // namespace kelp

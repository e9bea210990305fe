// SPDX-License-Identifier: MIT
// True if a number, or every number of a vector, is neither infinite nor NaN.
#pragma once

#include <cmath>

#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace kelp {

inline bool isFinite(float v) { return std::isfinite(v); }
inline bool isFinite(const glm::vec3& v) { return isFinite(v.x) && isFinite(v.y) && isFinite(v.z); }
inline bool isFinite(const glm::vec4& v) {
  return isFinite(v.x) && isFinite(v.y) && isFinite(v.z) && isFinite(v.w);
}
inline bool isFinite(const glm::mat4x3& m) {
  return isFinite(m[0]) && isFinite(m[1]) && isFinite(m[2]) && isFinite(m[3]);
}

// True if x, y, z, w are a rotation: a quaternion of length 1, up to rounding.
inline bool isRotation(const glm::vec4& q) {
  const float norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  return norm > 0.998f && norm < 1.002f;
}

}  // namespace kelp

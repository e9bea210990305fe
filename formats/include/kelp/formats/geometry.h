// SPDX-License-Identifier: MIT
// Geometric types that every library of kelp shares.
#pragma once

#include <cstddef>
#include <type_traits>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace kelp {

// With another layout of GLM's types, a host and kelp's libraries would disagree about every struct: numbers
// would be scrambled, rotations first.
template <class T, class Same>
inline constexpr bool kSameLayout = std::is_same_v<T, Same> && alignof(T) == alignof(float);
static_assert(
    kSameLayout<glm::vec3, glm::vec<3, float, glm::packed_highp>> && sizeof(glm::vec3) == 12 &&
        kSameLayout<glm::mat4, glm::mat<4, 4, float, glm::packed_highp>> &&
        kSameLayout<glm::ivec3, glm::vec<3, int, glm::packed_highp>>,
    "kelp needs GLM without GLM_FORCE_DEFAULT_ALIGNED_GENTYPES: remove it for all that includes kelp");
// Between 0.9.9.8 and 1.0, GLM_FORCE_QUAT_DATA_XYZW turned the constructor around as well.
#if defined(GLM_FORCE_QUAT_CTOR_XYZW) || defined(GLM_FORCE_QUAT_DATA_XYZW)
inline constexpr bool kQuatTakesWFirst = false;
#else
inline constexpr bool kQuatTakesWFirst = true;
#endif
static_assert(
    kSameLayout<glm::quat, glm::qua<float, glm::packed_highp>> && offsetof(glm::quat, x) == 0 &&
        offsetof(glm::quat, w) == 12 && kQuatTakesWFirst,
    "kelp needs GLM without GLM_FORCE_QUAT_DATA_WXYZ, _DATA_XYZW and _CTOR_XYZW (remove them for all "
    "that includes kelp), in a version that stores x first, as 0.9.9.8 and 1.0 do");

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

// True if all numbers are finite and the matrix has an inverse: its determinant, in double precision, is not
// 0.
bool isInvertible(const glm::mat4x3& m);

// The bounds of the eight transformed corners of `box`. Empty for an empty box.
Box transformed(const glm::mat4& matrix, const Box& box);

}  // namespace kelp

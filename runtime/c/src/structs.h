// SPDX-License-Identifier: MIT
// Structs and numbers of kelp.h <-> those of C++.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "errors.h"
#include "kelp/c/asset.h"
#include "kelp/formats/buffer.h"
#include "kelp/formats/model.h"

namespace kelp::c {

// Sizes above this one are refused without a look at the tail: the number is not a size.
inline constexpr std::size_t kLargestTail = 4096;

// A struct whose size is `known` here and was `first` in the first version. Null is an error.
kelp_result checkSize(const void* data, std::size_t first, std::size_t known);

// The size of a struct in the first version. When one grows, say here what it was.
template <class T>
inline constexpr std::size_t kFirstSize = sizeof(T);

template <class T>
kelp_result checkStruct(const T* data) {
  static_assert(offsetof(T, struct_size) == 0);
  return checkSize(data, kFirstSize<T>, sizeof(T));
}
// Fields that the caller's struct lacks are zero.
template <class T>
kelp_result readStruct(const T* from, T& to) {
  if (const kelp_result bad = checkStruct(from)) return bad;
  to = {};
  std::memcpy(static_cast<void*>(&to), from, std::min<std::size_t>(from->struct_size, sizeof(T)));
  return KELP_OK;
}
// Writes all that fits, after checkStruct(to).
template <class T>
kelp_result writeStruct(T value, T* to) {
  value.struct_size = to->struct_size;
  std::memcpy(static_cast<void*>(to), &value, std::min<std::size_t>(to->struct_size, sizeof(T)));
  return KELP_OK;
}

kelp_result readAllocator(const kelp_allocator* from, Allocator& to);  // null: the default

// An enum's number, with 255 for what its 8 bits cannot hold: no enum of kelp's has so many values.
template <class E>
E toEnum(std::int32_t value) {
  return static_cast<E>(value >= 0 && value < 255 ? value : 255);
}

inline glm::vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
inline glm::vec3 vec3At(const float* v) { return {v[0], v[1], v[2]}; }
inline glm::quat quatAt(const float* v) { return glm::quat(v[3], v[0], v[1], v[2]); }
inline void put(const glm::quat& q, float* out) { out[0] = q.x, out[1] = q.y, out[2] = q.z, out[3] = q.w; }
inline void put(const glm::vec3& v, float* out) { std::copy_n(glm::value_ptr(v), 3, out); }
inline void put(const glm::vec4& v, float* out) { std::copy_n(glm::value_ptr(v), 4, out); }
inline void put(const glm::ivec3& v, std::int32_t* out) { std::copy_n(glm::value_ptr(v), 3, out); }
inline void put(const glm::mat4& m, float* out) { std::copy_n(glm::value_ptr(m), 16, out); }
inline kelp_text text(std::string_view view) { return {view.data(), view.size()}; }

// Arrays of structs without a struct_size have one layout in both languages.
template <class To, class From>
std::span<const To> same(const From* values, std::size_t count) {
  static_assert(sizeof(To) == sizeof(From) && alignof(To) == alignof(From));
  return {reinterpret_cast<const To*>(values), count};
}
static_assert(offsetof(kelp_knot, position) == offsetof(Knot, position) &&
              offsetof(kelp_knot, tangent) == offsetof(Knot, tangent));
static_assert(offsetof(kelp_material, emissive) == offsetof(Material, emissive) &&
              offsetof(kelp_material, metallic) == offsetof(Material, metallic) &&
              offsetof(kelp_material, roughness) == offsetof(Material, roughness));
static_assert(offsetof(kelp_key, value) == offsetof(Key, value) &&
              offsetof(kelp_key, in) == offsetof(Key, in) && offsetof(kelp_key, out) == offsetof(Key, out));

}  // namespace kelp::c

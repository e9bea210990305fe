// SPDX-License-Identifier: MIT
// Reads values one after the other from a table. The caller has checked the size.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "finite.h"
#include "layout.h"

namespace kelp {

class RecordReader {
 public:
  explicit RecordReader(std::span<const std::byte> bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}

  std::size_t at() const { return at_; }
  template <class T>
  T take() {
    assert(bytes_.size() - at_ >= sizeof(T));
    const T value = layout::load<T>(bytes_, at_);
    at_ += sizeof(T);
    return value;
  }
  std::uint32_t u32() { return take<std::uint32_t>(); }
  std::uint64_t u64() { return take<std::uint64_t>(); }
  float f32() { return take<float>(); }
  glm::vec3 vec3() { return take<glm::vec3>(); }
  glm::vec4 vec4() { return take<glm::vec4>(); }
  glm::mat4x3 mat4x3() { return take<glm::mat4x3>(); }
  static_assert(sizeof(glm::vec4) == 16 && sizeof(glm::mat4x3) == 48);

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_;
};

inline Error corrupt(const char* detail, std::size_t offset) { return {ErrorCode::kCorrupt, detail, offset}; }
inline Error tooLarge() { return {ErrorCode::kLimit, "the metadata are larger than the limits allow", 0}; }
inline Error outOfMemory(const char* detail) { return {ErrorCode::kOutOfMemory, detail}; }

}  // namespace kelp

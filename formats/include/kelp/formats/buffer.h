// SPDX-License-Identifier: MIT
// An array whose size may come from a file. If memory is short, functions return an error; nothing throws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "kelp/formats/error.h"

namespace kelp {

// The host's allocator. Both functions are called from every thread that uses the object. allocate returns
// null if memory is short. Memory must be aligned to 16 bytes.
struct Allocator {
  void* (*allocate)(void* user, std::size_t bytes) = [](void*, std::size_t bytes) {
    return std::malloc(bytes);
  };
  void (*deallocate)(void* user, void* memory, std::size_t bytes) = [](void*, void* memory, std::size_t) {
    std::free(memory);
  };
  void* user = nullptr;
};

// A contiguous array of trivially copyable values. Owns its memory; movable, not copyable. Not thread-safe.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 16);
  static constexpr std::size_t kSize =
      sizeof(T);  // NOLINT(bugprone-sizeof-expression): of a pointer, where the values are pointers

  static constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "an allocation failed"};

 public:
  Buffer() = default;
  explicit Buffer(const Allocator& allocator) : allocator_(allocator) {}
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    if (this != &other) {
      Buffer gone(std::move(other));
      swap(gone);
    }
    return *this;
  }
  ~Buffer() {
    if (data_) allocator_.deallocate(allocator_.user, data_, capacity_ * kSize);
  }

  // Replaces the content with `count` zeroed values. kOutOfMemory, with the content unchanged, if it is
  // short. The count has 64 bits on every machine, because a file may ask for more than 32 bits can address.
  Result<void> reset(std::uint64_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / kSize) return kNoMemory;
    const std::size_t size = static_cast<std::size_t>(count);
    T* fresh = nullptr;
    if (size > 0) {
      fresh = static_cast<T*>(allocator_.allocate(allocator_.user, size * kSize));
      if (!fresh) return kNoMemory;
      std::memset(static_cast<void*>(fresh), 0, size * kSize);
    }
    if (data_) allocator_.deallocate(allocator_.user, data_, capacity_ * kSize);
    data_ = fresh;
    size_ = capacity_ = size;
    return {};
  }
  // Resizes to `count` values of unspecified content. Allocates only if `count` exceeds the largest size so
  // far. kOutOfMemory, with the content unchanged, if memory is short.
  Result<void> reuse(std::uint64_t count) {
    if (count > capacity_) return reset(count);
    size_ = static_cast<std::size_t>(count);
    return {};
  }

  // Enlarges it to `count` values or more, at least to twice as many, and keeps the content. False, with
  // nothing changed, if memory is short.
  [[nodiscard]] bool grow(std::uint64_t count) {
    if (count <= size_) return true;
    Buffer more(allocator_);
    if (!more.reset(count > 2 * std::uint64_t{size_} ? count : 2 * std::uint64_t{size_})) return false;
    if (size_ > 0) std::memcpy(static_cast<void*>(more.data_), data_, size_ * kSize);
    swap(more);
    return true;
  }

  const Allocator& allocator() const { return allocator_; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  std::span<T> span() { return {data_, size_}; }
  std::span<const T> span() const { return {data_, size_}; }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(allocator_, other.allocator_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  Allocator allocator_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace kelp

// SPDX-License-Identifier: MIT
// The arrays of the CAGE chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kelp {

// Takes one array after the other.
class ArrayReader {
 public:
  ArrayReader(std::span<const std::byte> bytes, std::uint64_t at) : bytes_(bytes), at_(at) {}

  bool has(std::uint64_t bytes) const { return at_ <= bytes_.size() && bytes <= bytes_.size() - at_; }
  std::span<const std::uint8_t> bytes(std::size_t count) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes_.data() + at_);
    at_ += count;
    return {first, count};
  }
  // In planes.
  void numbers(std::span<std::uint32_t> out) {
    for (std::uint32_t& number : out) number = 0;
    for (unsigned plane = 0; plane < 4; ++plane)
      for (std::uint32_t& number : out)
        number |= std::to_integer<std::uint32_t>(bytes_[at_++]) << (8 * plane);
  }
  bool done() const { return at_ == bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t at_;
};

// Takes the first `count` of what is left.
template <class T>
std::span<T> take(std::span<T>& from, std::uint64_t count) {
  const std::span<T> taken = from.first(static_cast<std::size_t>(count));
  from = from.subspan(taken.size());
  return taken;
}

// Of one list: from differences, less 1.
inline void sumAscending(std::span<std::uint32_t> numbers) {
  std::uint32_t least = 0;
  for (std::uint32_t& number : numbers) {
    number += least;
    least = number + 1;
  }
}
// 2 d, or -2 d - 1 if d < 0.
inline std::int32_t unfolded(std::uint32_t number) {
  return static_cast<std::int32_t>(number & 1 ? ~(number >> 1) : number >> 1);
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
// The codes of eight voxels in one word, the first in the lowest byte. Ranks are counted eight at a time,
// without branches.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "kelp/formats/brick.h"

namespace kelp {

// Byte i of [eight]: bit i.
inline constexpr auto kBytesOfBits = [] {
  std::array<std::uint64_t, 256> bytes{};
  for (std::size_t eight = 0; eight < bytes.size(); ++eight)
    for (std::size_t i = 0; i < 8; ++i) bytes[eight] |= std::uint64_t{eight >> i & 1} << (8 * i);
  return bytes;
}();

struct EightCodes {
  static constexpr std::size_t kSlice = 64;
  static constexpr std::uint64_t kOnes = 0x0101010101010101u;

  static_assert(std::endian::native == std::endian::little, "the first code is the lowest byte");
  // Bits of surface and of solid voxels; surface voxels are solid. The others are 0.
  EightCodes(std::uint8_t surface, std::uint8_t solid)
      : codes(kBytesOfBits[surface] * kSurfaceCode | kBytesOfBits[solid & ~surface] * kInnerCode) {}
  explicit EightCodes(const std::uint8_t* from) { std::memcpy(&codes, from, sizeof codes); }
  void store(std::uint8_t* to) const { std::memcpy(to, &codes, sizeof codes); }

  // A 1 in the byte of each voxel whose code has bit 6. If no code is reserved, these are the surface
  // voxels.
  std::uint64_t surface() const { return codes >> 6 & kOnes; }
  std::uint64_t surfaceBytes() const { return surface() * 0xff; }
  // The sum of all bytes is the highest byte of the product. Without a processor instruction for it,
  // std::popcount is slower.
  std::uint64_t surfaceVoxels() const { return surface() * kOnes >> 56; }
  // Not 0 if a code is above kInnerCode.
  std::uint64_t reservedBits() const { return codes & (codes >> 7 & kOnes) * 0x7f; }
  // In the byte of each surface voxel: its code if the first surface voxel here has rank `rank` in its
  // slice. Other bytes are undefined. Byte i of the product with kOnes is the sum of bytes 0 to i; no sum
  // exceeds 63 + 8.
  std::uint64_t ranked(std::uint64_t rank) const {
    return (surface() * kOnes - surface()) + (kSurfaceCode + rank) * kOnes;
  }

  std::uint64_t codes = 0;
};

}  // namespace kelp

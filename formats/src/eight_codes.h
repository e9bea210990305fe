// SPDX-License-Identifier: MIT
// Eight voxels' codes in a word, the first in the lowest byte, so that ranks are counted eight at a time and without a branch.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "kelp/formats/brick.h"

namespace kelp {

struct EightCodes {
  static constexpr std::size_t kSlice = 64;
  static constexpr std::uint64_t kOnes = 0x0101010101010101u;

  static_assert(std::endian::native == std::endian::little, "the first code is the lowest byte");
  explicit EightCodes(const std::uint8_t* from) { std::memcpy(&codes, from, sizeof codes); }
  void store(std::uint8_t* to) const { std::memcpy(to, &codes, sizeof codes); }

  // A one in the byte of each voxel whose code has bit 6: the surface voxels, if nothing is reserved.
  std::uint64_t surface() const { return codes >> 6 & kOnes; }
  std::uint64_t surfaceBytes() const { return surface() * 0xff; }
  // The highest byte of the product is the sum of all. Without an instruction for it, std::popcount is a call.
  std::uint64_t surfaceVoxels() const { return surface() * kOnes >> 56; }
  // Not 0 if a code is above kInnerCode.
  std::uint64_t reservedBits() const { return codes & (codes >> 7 & kOnes) * 0x7f; }
  // The code of the n-th of the surface voxels from here on, the first being the `rank`-th of its slice, in its byte; other bytes mean nothing.
  // A byte of the product with kOnes is the sum of the bytes up to it; none is above 63 + 8.
  std::uint64_t ranked(std::uint64_t rank) const { return (surface() * kOnes - surface()) + (kSurfaceCode + rank) * kOnes; }

  std::uint64_t codes = 0;
};

}  // namespace kelp

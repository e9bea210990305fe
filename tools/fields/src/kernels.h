// SPDX-License-Identifier: MIT
// The inner loops of this library, one table a flavour. All flavours compute the same integers.
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

namespace kelp::fields {

// Adjacent pencils that the y and z passes treat together: 256 bytes of every row, several vectors of the
// widest machine, so that the latency of one vector's arithmetic hides behind the others.
inline constexpr int kTileWidth = 64;

struct Kernels {
  // First pass, over `row_count` consecutive rows of `count` voxels: squared[x] = squared distance to the
  // nearest set voxel of the same row, kNoFeature if there is none. scratch: rowScratch(count) values.
  void (*rows)(const std::uint8_t* set, int count, int row_count, std::uint16_t* scratch,
               std::uint32_t* squared);

  // A further pass, in place, over a tile of `width` <= kTileWidth adjacent pencils of `count` values,
  // `stride` values apart: new[i] = min over j of old[j] + (i - j)^2, where old[j] is not kNoFeature.
  // scratch: envelopeScratch(count) values.
  void (*envelopes)(std::uint32_t* values, std::size_t stride, int count, int width, std::int32_t* scratch);

  // out[x] = largest of the bytes x - 1, x and x + 1 of all `row_count` >= 1 rows; bytes beyond the ends are
  // 0. scratch: neighborScratch(count) bytes.
  void (*largest)(const std::uint8_t* const* rows, int row_count, int count, std::uint8_t* scratch,
                  std::uint8_t* out);

  // Bit x % 64 of words[x / 64] = whether bytes[x] is not 0. Bits beyond the last byte are 0.
  void (*bits)(const std::uint8_t* bytes, int count, std::uint64_t* words);
};

inline std::size_t rowScratch(int count) { return 6 * static_cast<std::size_t>(count) + 512; }
inline std::size_t envelopeScratch(int count) { return 2 * static_cast<std::size_t>(count) * kTileWidth; }
inline std::size_t neighborScratch(int count) { return static_cast<std::size_t>(count) + 2; }

// Plain C++, for volumes of every size up to kMaxSide.
const Kernels& plainKernels();
// The fastest for volumes within fitsFastKernels: Highway for the machine's vectors (kernels_highway.cpp), or
// the plain ones (kernels_none.cpp).
const Kernels& fastKernels();

// Signed 32-bit lanes hold f + i^2 plus the product 2 s (i - j) of the envelope test: squares of all sides
// and twice the largest.
inline bool fitsFastKernels(const glm::ivec3& size) {
  const auto square = [](int side) { return std::int64_t{side} * side; };
  const int largest =
      size.x > size.y ? (size.x > size.z ? size.x : size.z) : (size.y > size.z ? size.y : size.z);
  return square(size.x) + square(size.y) + square(size.z) + 2 * square(largest) <= INT32_MAX;
}
inline const Kernels& kernelsFor(const glm::ivec3& size) {
  return fitsFastKernels(size) ? fastKernels() : plainKernels();
}

}  // namespace kelp::fields

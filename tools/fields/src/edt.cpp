// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "check.h"
#include "kelp/fields/fields.h"
#include "kernels.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

// The envelopes of `pencils` adjacent pencils of `count` values, tile by tile.
void envelopePass(const Kernels& kernels, std::uint32_t* values, std::size_t stride, int count,
                  std::int64_t pencils, std::int32_t* scratch) {
  for (std::int64_t x = 0; x < pencils; x += kTileWidth) {
    kernels.envelopes(values + x, stride, count,
                      static_cast<int>(std::min<std::int64_t>(kTileWidth, pencils - x)), scratch);
  }
}

}  // namespace

void squaredDistance(std::span<const std::uint8_t> set, const glm::ivec3& size,
                     std::span<std::uint32_t> squared, int threads) {
  checkedVolume(set.size(), size);
  checkedVolume(squared.size(), size);
  const Kernels& kernels = kernelsFor(size);
  const auto row = static_cast<std::size_t>(size.x);
  const std::size_t slice = row * static_cast<std::size_t>(size.y);

  // x and y, slice by slice: the slice is still in the cache when the y pass begins.
  parallelFor(size.z, grainOf(static_cast<std::int64_t>(slice)), threads,
              [&](std::int64_t begin, std::int64_t end) {
                const std::unique_ptr<std::uint16_t[]> row_scratch(new std::uint16_t[rowScratch(size.x)]);
                const std::unique_ptr<std::int32_t[]> scratch(new std::int32_t[envelopeScratch(size.y)]);
                for (std::int64_t z = begin; z < end; ++z) {
                  const std::size_t first = static_cast<std::size_t>(z) * slice;
                  kernels.rows(set.data() + first, size.x, size.y, row_scratch.get(), squared.data() + first);
                  envelopePass(kernels, squared.data() + first, row, size.y, size.x, scratch.get());
                }
              });
  if (size.z == 1) return;
  // z, over tiles of the whole xy plane.
  const auto tiles = static_cast<std::int64_t>((slice + kTileWidth - 1) / kTileWidth);
  parallelFor(tiles, grainOf(std::int64_t{kTileWidth} * size.z), threads,
              [&](std::int64_t begin, std::int64_t end) {
                const std::unique_ptr<std::int32_t[]> scratch(new std::int32_t[envelopeScratch(size.z)]);
                const std::int64_t first = begin * kTileWidth;
                const std::int64_t last = std::min(end * kTileWidth, static_cast<std::int64_t>(slice));
                envelopePass(kernels, squared.data() + first, slice, size.z, last - first, scratch.get());
              });
}

std::vector<std::uint32_t> squaredClearance(const Occupancy& occupancy, int threads) {
  const std::vector<std::uint8_t> dilated = dilate26(occupancy, threads);
  std::vector<std::uint32_t> squared(dilated.size());
  squaredDistance(dilated, occupancy.size, squared, threads);
  return squared;
}

}  // namespace kelp::fields

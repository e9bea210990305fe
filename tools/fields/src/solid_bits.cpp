// SPDX-License-Identifier: MIT
#include "kelp/fields/solid_bits.h"

#include <atomic>
#include <bit>

#include "check.h"
#include "kelp/formats/brick.h"
#include "kernels.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

std::size_t widthOf(const glm::ivec3& size) {
  return static_cast<std::size_t>(1 + (size.x + SolidBits::kWordVoxels - 1) / SolidBits::kWordVoxels);
}
std::size_t withMargins(int bricks) { return static_cast<std::size_t>(bricks) * kBrickSide + 2; }

// The margin behind the last row is the word beyond it.
std::size_t wordsOf(const glm::ivec3& size) {
  const glm::ivec3 grid = brickGrid(size);
  return widthOf(size) * withMargins(grid.y) * withMargins(grid.z) + 1;
}

}  // namespace

SolidBits::SolidBits(const glm::ivec3& size) : size_(size) {
  checkedVolume(size);
  width_ = widthOf(size);
  height_ = withMargins(brickGrid(size).y);
  bits_.resize(wordsOf(size));
}

SolidBits::SolidBits(const Occupancy& occupancy, int threads)
    : SolidBits((checkedVolume(occupancy.solid.size(), occupancy.size), occupancy.size)) {
  const Kernels& kernels = fastKernels();
  parallelFor(size_.z, grainOf(std::int64_t{size_.x} * size_.y), threads,
              [&](std::int64_t begin, std::int64_t end) {
                for (int z = static_cast<int>(begin); z < end; ++z)
                  for (int y = 0; y < size_.y; ++y)
                    kernels.bits(occupancy.solid.data() + occupancy.index({0, y, z}), size_.x, row(y, z));
              });
}

std::uint64_t SolidBits::count(int threads) const {
  std::atomic<std::uint64_t> all{0};
  parallelRanges(bits_.size(), 1 << 16, threads, [&](std::size_t begin, std::size_t end) {
    std::uint64_t sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += static_cast<std::uint64_t>(std::popcount(bits_[i]));
    all += sum;
  });
  return all;
}

std::uint64_t SolidBits::bytes(const glm::ivec3& size) { return wordsOf(size) * sizeof(std::uint64_t); }

}  // namespace kelp::fields

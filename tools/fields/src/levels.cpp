// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "check.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "parallel.h"

namespace kelp::fields {

namespace {

// Bits 0, 2, 4, ..., together.
std::uint64_t evenBits(std::uint64_t word) {
  word &= 0x5555555555555555u;
  word = (word | word >> 1) & 0x3333333333333333u;
  word = (word | word >> 2) & 0x0f0f0f0f0f0f0f0fu;
  word = (word | word >> 4) & 0x00ff00ff00ff00ffu;
  word = (word | word >> 8) & 0x0000ffff0000ffffu;
  return (word | word >> 16) & 0xffffffffu;
}

}  // namespace

SolidBits coarser(const SolidBits& bits, int threads) {
  SolidBits half(levelSize(bits.size(), 1));
  const glm::ivec3& size = half.size();
  parallelFor(
      size.z, grainOf(std::int64_t{size.x} * size.y), threads, [&](std::int64_t begin, std::int64_t end) {
        for (int z = static_cast<int>(begin); z < end; ++z) {
          for (int y = 0; y < size.y; ++y) {
            const std::uint64_t* const fine[4] = {bits.row(2 * y, 2 * z), bits.row(2 * y + 1, 2 * z),
                                                  bits.row(2 * y, 2 * z + 1), bits.row(2 * y + 1, 2 * z + 1)};
            std::uint64_t* const coarse = half.row(y, z);
            for (int i = 0; i < bits.words(); ++i) {
              const std::uint64_t any = fine[0][i] | fine[1][i] | fine[2][i] | fine[3][i];
              coarse[i / 2] |= evenBits(any | any >> 1) << (i % 2 * 32);
            }
          }
        }
      });
  return half;
}

Occupancy coarser(const Occupancy& occupancy, int threads) {
  checkedVolume(occupancy.solid.size(), occupancy.size);
  Occupancy half;
  half.size = levelSize(occupancy.size, 1);
  half.solid.resize(checkedVolume(half.size));
  parallelFor(half.size.z, grainOf(std::int64_t{4} * half.size.x * half.size.y), threads,
              [&](std::int64_t begin, std::int64_t end) {
                for (int z = 2 * static_cast<int>(begin);
                     z < std::min(2 * static_cast<int>(end), occupancy.size.z); ++z) {
                  for (int y = 0; y < occupancy.size.y; ++y) {
                    const std::uint8_t* const fine = occupancy.solid.data() + occupancy.index({0, y, z});
                    std::uint8_t* const coarse = half.solid.data() + half.index({0, y / 2, z / 2});
                    // Pairs first, in a loop that compilers make vectors of.
                    for (int x = 0; x < occupancy.size.x / 2; ++x)
                      coarse[x] |= static_cast<std::uint8_t>((fine[2 * x] | fine[2 * x + 1]) != 0);
                    if (occupancy.size.x % 2 != 0)
                      coarse[occupancy.size.x / 2] |=
                          static_cast<std::uint8_t>(fine[occupancy.size.x - 1] != 0);
                  }
                }
              });
  return half;
}

Occupancy occupancyOf(const RawLevel& level, const glm::ivec3& size) {
  Occupancy occupancy;
  occupancy.size = size;
  occupancy.solid.resize(checkedVolume(size));
  const glm::ivec3 grid = brickGrid(size);
  if (level.cells.size() != checkedVolume(grid)) {
    throw std::invalid_argument("a level has " + std::to_string(level.cells.size()) + " cells instead of " +
                                std::to_string(checkedVolume(grid)));
  }
  const std::size_t slots = level.codes.size() / kBrickVoxels;
  if (level.codes.size() % kBrickVoxels != 0)
    throw std::invalid_argument("the codes of a level are not whole bricks");

  const std::uint32_t* cell = level.cells.data();
  glm::ivec3 brick{0};
  for (brick.z = 0; brick.z < grid.z; ++brick.z) {
    for (brick.y = 0; brick.y < grid.y; ++brick.y) {
      for (brick.x = 0; brick.x < grid.x; ++brick.x, ++cell) {
        if (!(*cell & kCellSolid)) continue;
        static constexpr auto kInside = [] {
          std::array<std::uint8_t, kBrickVoxels> codes{};
          codes.fill(kInnerCode);
          return codes;
        }();
        const std::size_t slot = *cell & kCellSlotMask;
        if (*cell != kCellInside && slot >= slots) {
          throw std::invalid_argument("a cell names slot " + std::to_string(slot) + " of a level with " +
                                      std::to_string(slots));
        }
        const std::uint8_t* code =
            *cell == kCellInside ? kInside.data() : level.codes.data() + slot * kBrickVoxels;
        for (int i = 0; i < kBrickVoxels; ++i, ++code) {
          if (!isSolidCode(*code)) continue;
          const glm::ivec3 voxel = brick * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
          if (voxel.x >= size.x || voxel.y >= size.y || voxel.z >= size.z)
            throw std::invalid_argument("a solid voxel lies outside its volume");
          occupancy.solid[occupancy.index(voxel)] = 1;
        }
      }
    }
  }
  return occupancy;
}

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
#include "bricks.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "check.h"
#include "kelp/common/dense_index.h"
#include "parallel.h"

namespace kelp::fields {

BrickCells buildCells(const SolidBits& bits, std::span<const std::uint8_t> has_surface, int threads) {
  const glm::ivec3 grid = brickGrid(bits.size());
  BrickCells out;
  out.cells.resize(checkedVolume(grid));
  const std::vector<std::uint8_t> clearances = brickClearances(bits, threads);
  parallelFor(grid.z, grainOf(std::int64_t{grid.x} * grid.y * kBrickVoxels), threads,
              [&](std::int64_t begin, std::int64_t end) {
                // OR and AND of the 64 voxel rows of a row of bricks: one byte for each brick.
                std::vector<std::uint64_t> any(static_cast<std::size_t>(bits.words())), all(any.size());
                for (int z = static_cast<int>(begin); z < end; ++z) {
                  for (int y = 0; y < grid.y; ++y) {
                    std::fill(any.begin(), any.end(), std::uint64_t{0});
                    std::fill(all.begin(), all.end(), ~std::uint64_t{0});
                    for (int i = 0; i < kBrickSide * kBrickSide; ++i) {
                      const std::uint64_t* const row =
                          bits.row(y * kBrickSide + i % kBrickSide, z * kBrickSide + i / kBrickSide);
                      for (std::size_t word = 0; word < any.size(); ++word) {
                        any[word] |= row[word];
                        all[word] &= row[word];
                      }
                    }
                    for (int x = 0; x < grid.x; ++x) {
                      const std::size_t i = denseIndex(grid, x, y, z), word = static_cast<std::size_t>(x / 8);
                      const int shift = x % 8 * 8;
                      out.cells[i] =
                          (any[word] >> shift & 0xff) == 0
                              ? std::uint32_t{clearances[i]} << kCellClearanceShift
                          : !has_surface.empty() && !has_surface[i] && (all[word] >> shift & 0xff) == 0xff
                              ? kCellInside
                              : kCellSolid;
                    }
                  }
                }
              });
  std::vector<std::pair<std::uint64_t, glm::ivec3>> ordered;
  glm::ivec3 brick{0};
  for (brick.z = 0; brick.z < grid.z; ++brick.z) {
    for (brick.y = 0; brick.y < grid.y; ++brick.y) {
      for (brick.x = 0; brick.x < grid.x; ++brick.x) {
        if (isStoredCell(out.cells[denseIndex(grid, brick)])) ordered.emplace_back(mortonCode(brick), brick);
      }
    }
  }
  if (ordered.size() > std::size_t{kCellSlotMask} + 1) {
    throw std::invalid_argument("a level holds at most 16777216 bricks, this one would need " +
                                std::to_string(ordered.size()));
  }
  std::sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  out.stored.reserve(ordered.size());
  for (const auto& [code, position] : ordered) {
    out.cells[denseIndex(grid, position)] = kCellSolid | static_cast<std::uint32_t>(out.stored.size());
    out.stored.push_back(position);
  }
  return out;
}

}  // namespace kelp::fields

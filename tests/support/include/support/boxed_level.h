// SPDX-License-Identifier: MIT
// Levels with empty boxes, as rays need them.
#pragma once

#include <new>
#include <span>

#include "kelp/fields/fields.h"
#include "kelp/formats/empty_boxes.h"

namespace kelp::test {

// The level of fields::buildLevel, with the best boxes that there are: no voxel is unknown, as some are to
// the reader of a page.
inline RawLevel boxedLevel(const fields::Occupancy& volume, std::span<const fields::SurfaceVoxel> surface,
                           int threads) {
  RawLevel level = fields::buildLevel(volume, surface, threads);
  const glm::ivec3 grid = brickGrid(volume.size);
  if (!growBoxes(level.cells, grid)) throw std::bad_alloc();
  const auto isSolid = [&](const glm::ivec3& v) {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < volume.size.x && v.y < volume.size.y &&
           v.z < volume.size.z && volume.solid[volume.index(v)] != 0;
  };
  for (std::size_t cell = 0; cell < level.cells.size(); ++cell) {
    if (!isStoredCell(level.cells[cell])) continue;
    const glm::ivec3 first = kBrickSide * kelp::voxelAt(grid, cell);
    BoxWindow window{};
    for (int z = -kBoxReach; z < kBrickSide + kBoxReach; ++z)
      for (int y = -kBoxReach; y < kBrickSide + kBoxReach; ++y)
        for (int x = -kBoxReach; x < kBrickSide + kBoxReach; ++x)
          if (isSolid(first + glm::ivec3(x, y, z)))
            window.slices[(x + 8) / 8][(y + 8) / 8][z + kBoxReach] |= std::uint64_t{1}
                                                                      << ((x & 7) + 8 * (y & 7));
    const std::size_t slot = level.cells[cell] & kCellSlotMask;
    chooseBoxes(window,
                std::span<std::uint8_t, kBrickVoxels>(&level.codes[slot * kBrickVoxels], kBrickVoxels));
  }
  return level;
}

}  // namespace kelp::test

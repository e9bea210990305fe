// SPDX-License-Identifier: MIT
// Which voxels of a part are solid, for maps of points.
#pragma once

#include "../asset_impl.h"
#include "kelp/formats/page.h"

namespace kelp::runtime {

// Voxels of level 0; where their brick is not in memory, those of the finest level that is. All that is not
// known is solid.
struct SolidVoxels {
  SolidVoxels(const Asset& asset, int of)
      : reader(asset), part(of), levels(asset.pack().parts()[static_cast<std::size_t>(of)].levels) {}

  // The voxel must be in the part.
  bool isSolid(glm::ivec3 voxel) const {
    for (int l = 0; l < levels; ++l, voxel = voxel >> 1) {
      const LevelState* const level = reader.level(part, l);
      if (!level) continue;
      const glm::ivec3 brick = voxel >> 3, grid = level->data.grid;
      const auto row = static_cast<std::size_t>(brick.y) +
                       static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(brick.z);
      const std::uint32_t cell =
          level->data.cells[static_cast<std::size_t>(brick.x) + static_cast<std::size_t>(grid.x) * row];
      if (!(cell & kCellSolid)) return false;
      const std::uint32_t* const page = reader.words(*level, cellPage(cell));
      if (page) return isSolidCode(codeOf(page + kBrickWords * cellBrick(cell), voxel));
    }
    return true;
  }

  PageReader reader;
  int part, levels;
};

}  // namespace kelp::runtime

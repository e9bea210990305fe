// SPDX-License-Identifier: MIT
#include "pack/level_distances.h"
#include "kelp/formats/level.h"

#include <fmt/format.h>

#include "pack/level_grid.h"
#include "text/checks.h"

namespace kelp::dump {

LevelDistances::LevelDistances(PackFile& file, std::uint32_t part, int level) {
  const Pack& pack = file.pack();
  const std::string where = levelText(pack, part, level) + ", distances";
  const Result<LevelGrid> grid = pack.readDistanceGrid(static_cast<int>(part), level);
  if (!grid) file.fail(grid.error(), where);
  requireMemory(grid->cells.size() * 2 * sizeof(std::uint32_t) + grid->bricks.size() * kBrickVoxels,
                fmt::format("{}: {}:", file.path(), where), "use a coarser level, or a larger machine");
  size_ = grid->size;
  grid_ = grid->grid;
  raw_.band = grid->band;
  raw_.cells.reserve(grid->cells.size());
  for (const std::uint32_t cell : grid->cells)
    raw_.cells.push_back(cell & kCellSolid ? kCellSolid | grid->slotOf(cell) : cell);
  raw_.codes.reserve(grid->bricks.size() * kBrickVoxels);
  PageData page;
  for (std::size_t i = 0; i < grid->pages.size(); ++i) {
    if (const Result<void> read = pack.readPage(*grid, i, {}, page); !read) file.fail(read.error(), where);
    for (std::uint32_t brick = 0; brick < page.info.count; ++brick) {
      const std::span<const std::uint8_t> codes = page.codes(brick);
      raw_.codes.insert(raw_.codes.end(), codes.begin(), codes.end());
    }
  }
}

glm::vec3 LevelDistances::gradient(const glm::ivec3& voxel) const {
  std::uint8_t beside[6];
  for (int side = 0; side < 6; ++side) {
    glm::ivec3 at = voxel;
    at[side / 2] += side % 2 == 0 ? -1 : 1;
    beside[side] = code(at);
  }
  return distanceGradient(code(voxel), beside);
}

}  // namespace kelp::dump

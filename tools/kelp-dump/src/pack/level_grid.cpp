// SPDX-License-Identifier: MIT
#include "pack/level_grid.h"

#include <utility>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "kelp/formats/brick.h"
#include "kelp/formats/fog.h"
#include "text/text.h"

namespace kelp::dump {

std::string levelText(const Pack& pack, std::uint32_t part, int level) {
  return fmt::format("part {} '{}', level {}", part, nameText(pack.parts()[part].name), level);
}

LevelGrid readLevelGrid(PackFile& file, std::uint32_t part, int level) {
  Result<LevelGrid> grid = file.pack().readGrid(static_cast<int>(part), level);
  if (!grid) file.fail(grid.error(), levelText(file.pack(), part, level));
  return *std::move(grid);
}

void readLevelPage(PackFile& file, std::uint32_t part, int level, const PageInfo& info, PageData& page) {
  if (const Result<void> read = file.pack().readPage(info, page); !read)
    file.fail(read.error(), levelText(file.pack(), part, level));
}

RawLevel readLevelData(PackFile& file, std::uint32_t part, int level, const LevelGrid& grid) {
  const Fog* const fog = file.pack().parts()[part].fog;
  const std::size_t bricks = grid.bricks;
  RawLevel raw;
  raw.cells.assign(grid.cells.begin(), grid.cells.end());
  raw.codes.reserve(fog ? 0 : bricks * kBrickVoxels);
  raw.density.reserve(fog ? bricks * kFogSamples : 0);
  raw.heat.reserve(fog && fog->channels() == 2 ? bricks * kFogSamples : 0);
  PageData page;
  for (const PageInfo& info : grid.pages) {
    readLevelPage(file, part, level, info, page);
    raw.codes.insert(raw.codes.end(), page.codes.begin(), page.codes.end());
    raw.attributes.insert(raw.attributes.end(), page.attributes.begin(), page.attributes.end());
    const std::size_t samples = info.channels == 2 ? page.fog.size() / 2 : page.fog.size();
    raw.density.insert(raw.density.end(), page.fog.begin(), page.fog.begin() + samples);
    raw.heat.insert(raw.heat.end(), page.fog.begin() + samples, page.fog.end());
  }
  return raw;
}

std::vector<glm::ivec3> bricksBySlot(const LevelGrid& grid) {
  std::vector<glm::ivec3> bricks(grid.bricks);
  for (std::size_t c = 0; c < grid.cells.size(); ++c)
    if (isStoredCell(grid.cells[c])) bricks[grid.cells[c] & kCellSlotMask] = voxelAt(grid.grid, c);
  return bricks;
}

}  // namespace kelp::dump

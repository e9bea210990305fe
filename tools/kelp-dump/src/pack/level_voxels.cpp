// SPDX-License-Identifier: MIT
#include "pack/level_voxels.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "kelp/formats/level.h"
#include "pack/level_grid.h"
#include "text/checks.h"

namespace kelp::dump {
namespace {

// The memory that the level needs, known before any page is read: decoded pages and the tables beside them,
// and while they are read the grid once more, with the shapes of the coarser level, a quarter of this one's.
std::uint64_t memoryOf(const LevelGrid& grid) {
  std::uint64_t bytes =
      grid.cells.size() * sizeof(std::uint32_t) * 3 +
      grid.bricks.size() * (sizeof(glm::ivec3) + 8 * sizeof(std::uint32_t) + sizeof(BrickShape) / 2);
  for (const PageInfo& page : grid.pages) bytes += page.raw;
  return bytes;
}

}  // namespace

LevelVoxels::LevelVoxels(PackFile& file, std::uint32_t part_index, int level) {
  const Pack& pack = file.pack();
  const Part& part = pack.parts()[part_index];
  const Result<LevelGrid> read = pack.readGrid(static_cast<int>(part_index), level);
  if (!read) file.fail(read.error(), levelText(pack, part_index, level));
  const LevelGrid& grid = *read;
  requireMemory(memoryOf(grid), fmt::format("{}: {}:", file.path(), levelText(pack, part_index, level)),
                "extract a coarser --level, or use a larger machine");
  kind_ = part.kind;
  size_ = levelSize(part.size, level);
  grid_ = grid.grid;
  const double scale = std::ldexp(1.0, level);
  to_object_ = glm::dmat4x3(part.to_object);
  for (int axis = 0; axis < 3; ++axis) to_object_[axis] *= scale;
  if (fog()) extinction_ = part.fog->extinction[static_cast<std::size_t>(level)];
  raw_ = readLevelData(file, part_index, level);
  brick_of_slot_ = bricksBySlot(grid);
  for (std::size_t c = 0; c < grid.cells.size(); ++c)
    if (raw_.cells[c] == kCellInside) inside_.push_back(voxelAt(grid_, c));
  slice_base_.resize(raw_.codes.size() / kBrickVoxels * 8);
  (void)computeSliceBase(raw_.codes, 0, slice_base_);  // every page's ranks were checked as it was read
}

double LevelVoxels::edge() const { return std::cbrt(std::abs(glm::determinant(glm::dmat3(to_object_)))); }

std::optional<std::uint32_t> LevelVoxels::attribute(const glm::ivec3& voxel) const {
  const std::uint8_t here = code(voxel);
  if (!isSurfaceCode(here)) return std::nullopt;
  return attributeOf(cellOf(voxel) & kCellSlotMask, codeIndex(voxel), here);
}

void LevelVoxels::paletteRow(int y, int z, int from, std::span<std::int16_t> row) const {
  std::fill(row.begin(), row.end(), std::int16_t{kEmpty});
  const int beyond = from + static_cast<int>(row.size());
  std::int16_t last = 0;
  for (int first = 0; first < beyond; first += kBrickSide) {
    const std::uint32_t cell = cellOf({first, y, z}), slot = cell & kCellSlotMask;
    if (!(cell & kCellSolid)) continue;
    for (int x = first; x < std::min(first + kBrickSide, beyond); ++x) {
      const int index = codeIndex({x, y, z});
      const std::uint8_t here =
          cell == kCellInside
              ? kInnerCode
              : raw_.codes[std::size_t{slot} * kBrickVoxels + static_cast<std::size_t>(index)];
      if (isSurfaceCode(here)) last = attributePalette(attributeOf(slot, index, here));
      if (x >= from && isSolidCode(here)) row[static_cast<std::size_t>(x - from)] = last;
    }
  }
}

bool LevelVoxels::anyBrick(int from, int beyond, int y, int z) const {
  for (int x = from / kBrickSide * kBrickSide; x < beyond; x += kBrickSide)
    if (cellOf({x, y, z}) & kCellSolid) return true;
  return false;
}

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#include "raw_pack_check.h"

#include <array>
#include <span>

#include "morton_walk.h"
#include "voxels.h"

namespace kelp {
namespace {

Error misuse(const char* detail) { return {ErrorCode::kMisuse, detail}; }

}  // namespace

Result<void> checkRawLevel(const RawLevel& level, const glm::ivec3& size, std::size_t palette_size) {
  const glm::ivec3 grid = brickGrid(size);
  if (level.cells.size() != cellCount(grid)) return misuse("a level has not one cell for each brick of its grid");
  const Result<std::uint32_t> bricks = checkCells(level.cells, grid);
  if (!bricks) return misuse(bricks.error().detail);
  const std::span<const std::uint8_t> codes(level.codes);
  if (codes.size() != std::size_t{*bricks} * kBrickVoxels) return misuse("a level has not 512 codes for each stored brick");

  std::uint64_t attributes = 0;
  std::size_t slot = 0;
  for (MortonWalk walk(grid); !walk.done(); walk.next()) {
    if (!(level.cells[static_cast<std::size_t>(walk.index())] & kCellSolid)) continue;
    const auto brick = codes.subspan(slot++ * kBrickVoxels, kBrickVoxels);
    std::array<std::uint32_t, 8> slice_base;
    const std::int64_t surface = computeSliceBase(brick, 0, slice_base);
    if (surface < 0) return misuse("a brick holds a reserved code or a wrong rank");
    if (findBrickWithoutSolid(brick) >= 0) return misuse("a stored brick holds no solid voxel");
    if (hasSolidOutside(brick, walk.cell(), size)) return misuse("a brick holds a solid voxel outside the level");
    attributes += static_cast<std::uint64_t>(surface);
  }
  if (level.attributes.size() != attributes) return misuse("a level has not one attribute for each surface voxel");
  if (findWrongPaletteIndex(level.attributes, palette_size) >= 0)
    return misuse("an attribute names a palette entry that is not there");
  return {};
}

}  // namespace kelp

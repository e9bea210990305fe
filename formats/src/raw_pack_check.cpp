// SPDX-License-Identifier: MIT
#include "metadata_writer.h"

#include <array>
#include <span>

#include "distance_pages.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/page.h"
#include "morton_walk.h"
#include "voxels.h"

namespace kelp {
namespace {

Result<void> checkFogLevel(const RawLevel& level, const glm::ivec3& samples, bool heat) {
  const glm::ivec3 grid = brickGrid(latticeSize(PartKind::kFog, samples));
  if (level.cells.size() != cellCount(grid))
    return misuse("a level does not have one cell for each brick of its grid");
  const Result<std::uint32_t> bricks =
      checkCells(level.cells, {latticeSize(PartKind::kFog, samples), heat ? 2 : 1});
  if (!bricks) return misuse(bricks.error().detail);
  const std::size_t bytes = std::size_t{*bricks} * kFogSamples;
  if (level.density.size() != bytes || level.heat.size() != (heat ? bytes : 0))
    return misuse("a level of fog does not have 729 samples for each stored brick");
  if (!level.codes.empty() || !level.attributes.empty())
    return misuse("a level of fog has codes or attributes");
  std::size_t slot = 0;
  for (MortonWalk walk(grid); !walk.done(); walk.next()) {
    if (!(level.cells[static_cast<std::size_t>(walk.index())] & kCellSolid)) continue;
    const auto samplesOf = [&](const std::vector<std::uint8_t>& channel) {
      return std::span(channel).subspan(slot * kFogSamples, kFogSamples);
    };
    if (hasFogOutside(samplesOf(level.density), walk.cell(), samples) ||
        (heat && hasFogOutside(samplesOf(level.heat), walk.cell(), samples)))
      return misuse("a brick of fog has a sample outside the level");
    if (findClearBrick(samplesOf(level.density), 1) >= 0 &&
        !(heat && findClearBrick(samplesOf(level.heat), 1) < 0))
      return misuse("a stored brick holds no fog");
    ++slot;
  }
  return {};
}

}  // namespace

Result<void> checkRawLevel(const RawPart& part, std::size_t index, std::size_t palette_size) {
  const RawLevel& level = part.levels[index];
  const glm::ivec3 size = levelSize(part.size, static_cast<int>(index));
  if (part.fog) return checkFogLevel(level, size, !part.fog->ramp.empty());
  if (!level.density.empty() || !level.heat.empty())
    return misuse("a level of a solid part has samples of fog");
  const glm::ivec3 grid = brickGrid(size);
  if (level.cells.size() != cellCount(grid))
    return misuse("a level does not have one cell for each brick of its grid");
  const Result<std::uint32_t> bricks = checkCells(level.cells, {size, 0});
  if (!bricks) return misuse(bricks.error().detail);
  const std::span<const std::uint8_t> codes(level.codes);
  if (codes.size() != std::size_t{*bricks} * kBrickVoxels)
    return misuse("a level does not have 512 codes for each stored brick");

  std::uint64_t attributes = 0;
  std::size_t slot = 0;
  for (MortonWalk walk(grid); !walk.done(); walk.next()) {
    if (!isStoredCell(level.cells[static_cast<std::size_t>(walk.index())])) continue;
    const auto brick = codes.subspan(slot++ * kBrickVoxels, kBrickVoxels);
    std::array<std::uint32_t, 8> slice_base;
    const Result<std::uint32_t> surface = computeSliceBase(brick, 0, slice_base);
    if (!surface) return misuse(surface.error().detail);
    if (findBrickWithoutSurface(brick) >= 0) return misuse("a stored brick holds no surface voxel");
    if (hasSolidOutside(brick, walk.cell(), size))
      return misuse("a brick holds a solid voxel outside the level");
    attributes += *surface;
  }
  if (level.attributes.size() != attributes)
    return misuse("a level does not have one attribute for each surface voxel");
  if (findWrongPaletteIndex(level.attributes, palette_size) >= 0)
    return misuse("an attribute names a palette entry that does not exist");
  return {};
}

Result<void> checkRawDistances(const RawDistances& level, const glm::ivec3& size) {
  if (!isPossibleBand(level.band)) return misuse("a band of distances is too narrow or too wide");
  if (level.cells.size() != cellCount(brickGrid(size)))
    return misuse("a level of distances does not have one cell for each brick of its grid");
  const Result<std::uint32_t> bricks = checkCells(level.cells, {size, PageInfo::kDistances});
  if (!bricks) return misuse(bricks.error().detail);
  if (level.codes.size() != std::size_t{*bricks} * kBrickVoxels)
    return misuse("a level of distances does not have 512 codes for each stored brick");
  return {};
}

}  // namespace kelp

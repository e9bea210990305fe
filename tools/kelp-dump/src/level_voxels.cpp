// SPDX-License-Identifier: MIT
#include "level_voxels.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/console/console.h"
#include "text.h"

namespace kelp::dump {
namespace {

// What the level takes in memory, known before any page is read: decoded pages, and what they are found by.
std::uint64_t memoryOf(const LevelGrid& grid) {
  std::uint64_t bytes = grid.cells.size() * sizeof(std::uint32_t) * 2 + std::uint64_t{grid.bricks} * (sizeof(glm::ivec3) + 8 * sizeof(std::uint32_t));
  for (const PageInfo& page : grid.pages) bytes += page.raw;
  return bytes;
}

}  // namespace

std::string levelText(const Pack& pack, std::uint32_t part, int level) {
  return fmt::format("part {} '{}', level {}", part, nameText(pack.parts()[part].name), level);
}

LevelVoxels::LevelVoxels(PackFile& file, std::uint32_t part_index, int level) {
  const Pack& pack = file.pack();
  const Part& part = pack.parts()[part_index];
  const auto where = [&] { return levelText(pack, part_index, level); };
  const Result<LevelGrid> grid = pack.readGrid(static_cast<int>(part_index), level);
  if (!grid) file.fail(grid.error(), where());
  if (const std::uint64_t needed = memoryOf(*grid), memory = console::physicalMemory(); needed > memory)
    throw DumpError(kFailure, fmt::format("{}: {}: needs {} of memory, this machine has {}; extract a coarser --level, or use a larger machine", file.path(), where(), bytesText(needed), bytesText(memory)));
  kind_ = part.kind;
  size_ = levelSize(part.size, level);
  grid_ = grid->grid;
  const double scale = std::ldexp(1.0, level);
  to_object_ = glm::dmat4x3(part.to_object);
  for (int axis = 0; axis < 3; ++axis) to_object_[axis] *= scale;
  if (fog()) extinction_ = part.fog->extinction[static_cast<std::size_t>(level)];
  raw_.cells.assign(grid->cells.begin(), grid->cells.end());
  brick_of_slot_.resize(grid->bricks);
  std::size_t at = 0;
  for (int z = 0; z < grid_.z; ++z)
    for (int y = 0; y < grid_.y; ++y)
      for (int x = 0; x < grid_.x; ++x, ++at)
        if (raw_.cells[at] & kCellSolid) brick_of_slot_[raw_.cells[at] & kCellSlotMask] = {x, y, z};
  PageData page;
  for (const PageInfo& info : grid->pages) {
    if (const Result<void> read = pack.readPage(info, page); !read) file.fail(read.error(), where());
    raw_.codes.insert(raw_.codes.end(), page.codes.begin(), page.codes.end());
    raw_.attributes.insert(raw_.attributes.end(), page.attributes.begin(), page.attributes.end());
    const std::size_t samples = fog() ? std::size_t{page.count} * kFogSamples : 0;
    raw_.density.insert(raw_.density.end(), page.fog.begin(), page.fog.begin() + samples);
    if (page.fog.size() > samples) raw_.heat.insert(raw_.heat.end(), page.fog.begin() + samples, page.fog.end());
  }
  slice_base_.resize(raw_.codes.size() / kBrickVoxels * 8);
  computeSliceBase(raw_.codes, 0, slice_base_);  // every page's ranks were checked as it was read
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
      const std::uint8_t here = raw_.codes[std::size_t{slot} * kBrickVoxels + static_cast<std::size_t>(index)];
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

void LevelVoxels::fogLayer(int y, std::span<std::uint8_t> density, std::span<std::uint8_t> heat) const {
  std::fill(density.begin(), density.end(), std::uint8_t{0});
  std::fill(heat.begin(), heat.end(), std::uint8_t{0});
  for (std::size_t slot = 0; slot < brick_of_slot_.size(); ++slot) {
    const glm::ivec3 low = brick_of_slot_[slot] * kBrickSide;
    if (y < low.y || y >= low.y + kFogSide) continue;
    for (int z = low.z; z < std::min(low.z + kFogSide, size_.z); ++z)
      for (int x = low.x; x < std::min(low.x + kFogSide, size_.x); ++x) {
        const std::size_t at = slot * kFogSamples + static_cast<std::size_t>(x - low.x + kFogSide * (y - low.y + kFogSide * (z - low.z)));
        const std::size_t pixel = static_cast<std::size_t>(x) + static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(z);
        density[pixel] = raw_.density[at];
        if (!heat.empty()) heat[pixel] = raw_.heat[at];
      }
  }
}

std::uint64_t LevelVoxels::solidVoxels() const {
  std::uint64_t count = 0;
  eachSolid([&](const glm::ivec3&) { ++count; });
  return count;
}

}  // namespace kelp::dump

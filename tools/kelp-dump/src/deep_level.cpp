// SPDX-License-Identifier: MIT
#include "deep_level.h"

#include <utility>

#include <fmt/format.h>

#include "emptiness.h"
#include "kelp/formats/fog.h"
#include "text.h"

namespace kelp::dump {

glm::ivec3 positionOf(std::uint64_t index, const glm::ivec3& size) {
  const auto x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
}

StoredLevel readStored(PackFile& file, const Place& place) {
  const Pack& pack = file.pack();
  const auto where = [&] { return fmt::format("part {} '{}', level {}", place.part, nameText(pack.parts()[static_cast<std::size_t>(place.part)].name), place.level); };
  const Result<LevelGrid> grid = pack.readGrid(place.part, place.level);
  if (!grid) file.fail(grid.error(), where());
  StoredLevel level;
  level.size = grid->size;
  level.grid = grid->grid;
  level.raw.cells.assign(grid->cells.begin(), grid->cells.end());
  level.brick_of_slot.resize(grid->bricks);
  for (std::size_t c = 0; c < level.raw.cells.size(); ++c) {
    if (level.raw.cells[c] & kCellSolid) level.brick_of_slot[level.raw.cells[c] & kCellSlotMask] = positionOf(c, level.grid);
  }
  const Fog* const fog = pack.parts()[static_cast<std::size_t>(place.part)].fog;
  level.raw.codes.reserve(fog ? 0 : std::size_t{grid->bricks} * kBrickVoxels);
  level.raw.density.reserve(fog ? std::size_t{grid->bricks} * kFogSamples : 0);
  level.raw.heat.reserve(fog && fog->channels() == 2 ? std::size_t{grid->bricks} * kFogSamples : 0);
  PageData page;
  for (const PageInfo& info : grid->pages) {
    if (const Result<void> read = pack.readPage(info, page); !read) file.fail(read.error(), where());
    level.raw.codes.insert(level.raw.codes.end(), page.codes.begin(), page.codes.end());
    level.raw.attributes.insert(level.raw.attributes.end(), page.attributes.begin(), page.attributes.end());
    const auto heats = page.fog.begin() + static_cast<std::ptrdiff_t>(info.channels == 2 ? page.fog.size() / 2 : page.fog.size());
    level.raw.density.insert(level.raw.density.end(), page.fog.begin(), heats);
    level.raw.heat.insert(level.raw.heat.end(), heats, page.fog.end());
  }
  return level;
}

void Tally::add(std::optional<glm::ivec3> brick, std::optional<glm::ivec3> voxel, std::string detail) {
  if (count_++ > 0) return;
  brick_ = brick;
  voxel_ = voxel;
  detail_ = std::move(detail);
}

void Tally::report(VerifyReport& into) const {
  if (count_ == 0) return;
  Finding finding;
  finding.id = static_cast<int>(issue_);
  finding.message = toString(issue_);
  finding.detail = detail_;
  finding.part = place_.part;
  finding.level = place_.level;
  finding.brick = brick_;
  finding.voxel = voxel_;
  finding.count = count_;
  into.findings.push_back(finding);
}

void compareCell(std::uint32_t stored, std::size_t index, std::span<const std::uint32_t> right, const glm::ivec3& grid, Tally& untrue, Tally& lesser) {
  if (stored == right[index]) return;
  const glm::ivec3 brick = positionOf(index, grid);
  const bool broken = breaksPromise(stored, brick, right, grid, cellClearance(right[index]));
  (broken ? untrue : lesser).add(brick, std::nullopt, fmt::format("box of {} stored, {} are right", cellText(stored), cellText(right[index])));
}

}  // namespace kelp::dump

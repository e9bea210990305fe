// SPDX-License-Identifier: MIT
#include "verify/deep_level.h"

#include <utility>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "pack/level_grid.h"
#include "verify/emptiness.h"

namespace kelp::dump {

StoredLevel readStored(PackFile& file, const Place& place) {
  const auto part = static_cast<std::uint32_t>(place.part);
  const LevelGrid grid = readLevelGrid(file, part, place.level);
  StoredLevel level;
  level.size = grid.size;
  level.grid = grid.grid;
  level.raw = readLevelData(file, part, place.level, grid);
  level.brick_of_slot = bricksBySlot(grid);
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

void compareCell(std::uint32_t stored, std::size_t index, std::span<const std::uint32_t> right,
                 const glm::ivec3& grid, Tally& untrue, Tally& lesser) {
  if (stored == right[index]) return;
  const glm::ivec3 brick = voxelAt(grid, index);
  const bool broken = breaksPromise(stored, brick, right, grid, cellClearance(right[index]));
  (broken ? untrue : lesser)
      .add(brick, std::nullopt,
           fmt::format("box of {} stored, {} are right", cellText(stored), cellText(right[index])));
}

}  // namespace kelp::dump

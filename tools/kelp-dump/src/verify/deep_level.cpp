// SPDX-License-Identifier: MIT
#include "verify/deep_level.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "kelp/formats/fog.h"
#include "pack/level_grid.h"

namespace kelp::dump {

StoredLevel readStored(PackFile& file, const LevelPlace& place) {
  const auto part = static_cast<std::uint32_t>(place.part);
  const Part& of = file.pack().parts()[part];
  StoredLevel level;
  level.size = latticeSize(of.kind, levelSize(of.size, place.level));
  level.grid = brickGrid(level.size);
  level.raw = readLevelData(file, part, place.level);
  for (std::size_t cell = 0; cell < level.raw.cells.size(); ++cell) {
    if (!isStoredCell(level.raw.cells[cell])) continue;
    level.brick_of_slot.resize(
        std::max<std::size_t>(level.brick_of_slot.size(), (level.raw.cells[cell] & kCellSlotMask) + 1));
    level.brick_of_slot[level.raw.cells[cell] & kCellSlotMask] = voxelAt(level.grid, cell);
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
  Issue issue;
  issue.id = static_cast<int>(issue_);
  issue.message = toString(issue_);
  issue.detail = detail_;
  issue.part = place_.part;
  issue.level = place_.level;
  issue.brick = brick_;
  issue.voxel = voxel_;
  issue.count = count_;
  into.issues.push_back(issue);
}

void compareClearances(const StoredLevel& level, const RawLevel& right, const LevelPlace& place,
                       VerifyReport& report) {
  Tally untrue(DeepIssueId::kFalseEmptiness, place), lesser(DeepIssueId::kNotBestEmptiness, place);
  for (std::size_t c = 0; c < right.cells.size(); ++c) {
    if (right.cells[c] & kCellSolid) continue;
    const int stored = cellClearance(level.raw.cells[c]), best = cellClearance(right.cells[c]);
    if (stored == best) continue;
    (stored > best ? untrue : lesser)
        .add(voxelAt(level.grid, c), std::nullopt,
             fmt::format("clearance of {} stored, {} is right", stored, best));
  }
  untrue.report(report);
  lesser.report(report);
}

}  // namespace kelp::dump

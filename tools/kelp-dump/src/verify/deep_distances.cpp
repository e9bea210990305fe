// SPDX-License-Identifier: MIT
#include "verify/deep_level.h"

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "pack/level_distances.h"

namespace kelp::dump {
namespace {

std::string distanceText(std::uint8_t code) {
  const char* const kind = isInside(code) ? "solid" : "empty";
  return squaredOf(code) == 0 ? fmt::format("{}, beyond the band", kind)
                              : fmt::format("{}, squared distance {}", kind, squaredOf(code));
}

}  // namespace

void checkDistances(PackFile& file, const LevelPlace& place, const fields::Occupancy& occupancy, int threads,
                    VerifyReport& report) {
  const LevelDistances stored(file, static_cast<std::uint32_t>(place.part), place.level);
  const RawDistances right = fields::buildDistances(occupancy, stored.raw().band, threads);
  Tally wrong(DeepIssueId::kDistance, place);
  for (std::size_t cell = 0; cell < right.cells.size(); ++cell) {
    const glm::ivec3 brick = voxelAt(stored.grid(), cell);
    const auto codeIn = [&](const RawDistances& level, int i) {
      const std::uint32_t at = level.cells[cell];
      return at & kCellSolid
                 ? level.codes[std::size_t{at & kCellSlotMask} * kBrickVoxels + static_cast<std::size_t>(i)]
                 : static_cast<std::uint8_t>(at);
    };
    for (int i = 0; i < kBrickVoxels; ++i) {
      const std::uint8_t is = codeIn(stored.raw(), i), should = codeIn(right, i);
      if (is == should) continue;
      wrong.add(brick, brick * kBrickSide + glm::ivec3(i & 7, i >> 3 & 7, i >> 6),
                fmt::format("{} stored, {} is right", distanceText(is), distanceText(should)));
    }
  }
  wrong.report(report);
}

}  // namespace kelp::dump

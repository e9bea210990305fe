// SPDX-License-Identifier: MIT
// Distances of a part, level by level: of its voxels, and then of halvings of its coarsest level.
#include <cmath>

#include "kelp/bake/bake.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"

namespace kelp::bake {

std::vector<RawDistances> buildDistances(const RawPart& part, int threads, const Progress& progress) {
  const int voxel_levels = static_cast<int>(part.levels.size());
  const int count = distanceLevels(part.size, voxel_levels);
  std::vector<RawDistances> built;
  fields::Occupancy coarse;  // beyond the voxels' levels
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("distances", 1 - std::pow(4.0, -level)))
      throw ToolError(Exit::kInterrupted, "interrupted");
    const DistanceBand band = distanceBand(part.size, voxel_levels, level);
    if (level < voxel_levels) {
      built.push_back(fields::buildDistances(part.levels[static_cast<std::size_t>(level)],
                                             levelSize(part.size, level), band, threadCount(threads)));
      continue;
    }
    if (level == voxel_levels)
      coarse = fields::occupancyOf(part.levels.back(), levelSize(part.size, level - 1));
    coarse = fields::coarser(coarse, threadCount(threads));
    built.push_back(fields::buildDistances(coarse, band, threadCount(threads)));
  }
  if (progress && !progress("distances", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake

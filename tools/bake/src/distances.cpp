// SPDX-License-Identifier: MIT
// Distances of a part, level by level, from the finest level of its voxels: the others are halvings of it.
#include <cmath>

#include "kelp/bake/bake.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"

namespace kelp::bake {

std::vector<RawDistances> buildDistances(const RawPart& part, int threads, const Progress& progress) {
  const int voxel_levels = static_cast<int>(part.levels.size());
  const int count = distanceLevels(part.size, voxel_levels);
  std::vector<RawDistances> built;
  fields::Occupancy occupancy = fields::occupancyOf(part.levels.front(), part.size);
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("distances", 1 - std::pow(4.0, -level)))
      throw ToolError(Exit::kInterrupted, "interrupted");
    if (level > 0) occupancy = fields::coarser(occupancy, threadCount(threads));
    built.push_back(fields::buildDistances(occupancy, distanceBand(part.size, voxel_levels, level),
                                           threadCount(threads)));
  }
  if (progress && !progress("distances", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake

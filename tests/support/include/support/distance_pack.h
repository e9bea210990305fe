// SPDX-License-Identifier: MIT
// Small packs with distances.
#pragma once

#include <vector>

#include "support/test_pack.h"

namespace kelp::test {

// All levels of distances of a volume with so many levels of voxels.
inline std::vector<RawDistances> distancesOf(fields::Occupancy volume, int levels) {
  std::vector<RawDistances> out;
  const glm::ivec3 size = volume.size;
  for (int level = 0; level < distanceLevels(size, levels); ++level) {
    if (level > 0) volume = fields::coarser(volume);
    out.push_back(fields::buildDistances(volume, distanceBand(size, levels, level), 1));
  }
  return out;
}

// packOf() with distances.
inline RawPack distancePackOf(const fields::Occupancy& volume, std::vector<Knot> knots = {}) {
  RawPack pack = packOf(volume, std::move(knots));
  pack.parts[0].distances = distancesOf(volume, static_cast<int>(pack.parts[0].levels.size()));
  return pack;
}

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Independent truth for kelp::fields: brute force over all pairs, and a plain scalar separable transform to
// compare speeds with.
#pragma once

#include <cstdint>
#include <vector>

#include "kelp/fields/fields.h"

namespace kelp::test {

// Squared distance between voxel centers, by trying every pair.
std::vector<std::uint32_t> bruteSquaredDistance(const std::vector<std::uint8_t>& set, const glm::ivec3& size);

// Squared distance between the closed boxes [low, low + extent] and [solid, solid + 1], from their corners.
std::int64_t squaredGap(const glm::ivec3& low, int extent, const glm::ivec3& solid);

// Squared clearance by its geometric definition: the least squaredGap to any solid voxel; 0 for solid voxels.
std::vector<std::uint32_t> bruteSquaredClearance(const fields::Occupancy& occupancy);

// The separable transform as Felzenszwalb and Huttenlocher print it, one pencil at a time, in doubles, on one
// thread: the yardstick of speed.
std::vector<std::uint32_t> naiveSeparable(const std::vector<std::uint8_t>& set, const glm::ivec3& size);

}  // namespace kelp::test

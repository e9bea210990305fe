// SPDX-License-Identifier: MIT
// Clearance of bricks from the bits of their voxels, without an array of all voxels' distances.
#pragma once

#include <cstdint>
#include <vector>

#include "kelp/fields/solid_bits.h"

namespace kelp::fields {

// For each brick of the grid, x fastest, the distance of its closed cube to the nearest solid voxel's, in
// voxels, rounded down, at most kCellMaxClearance; 0 for bricks that hold something.
std::vector<std::uint8_t> brickClearances(const SolidBits& bits, int threads);

// Bytes that it needs, its result included.
std::uint64_t brickClearanceBytes(const glm::ivec3& grid);

}  // namespace kelp::fields

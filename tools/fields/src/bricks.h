// SPDX-License-Identifier: MIT
// The grid of a level: the cell of every brick, and the clearance of empty bricks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kelp/fields/solid_bits.h"

namespace kelp::fields {

struct BrickCells {
  std::vector<std::uint32_t> cells;  // x fastest, then y, then z; as kelp/formats/brick.h
  std::vector<glm::ivec3> stored;    // bricks by slot
};

// Empty bricks get their clearance; full ones without surface (has_surface, one a brick, 0;
// of fog empty) kCellInside; the others a slot, in Morton order. Throws std::invalid_argument where slots do
// not suffice.
BrickCells buildCells(const SolidBits& bits, std::span<const std::uint8_t> has_surface, int threads);

// For each brick of the grid, x fastest, the distance of its closed cube to the nearest solid voxel's, in
// voxels, rounded down, at most kCellMaxClearance; 0 for bricks that hold something. Made from the bits of
// the voxels, without an array of all voxels' distances.
std::vector<std::uint8_t> brickClearances(const SolidBits& bits, int threads);

// Bytes that it needs, its result included.
std::uint64_t brickClearanceBytes(const glm::ivec3& grid);

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
// The grid of a level: what every brick's cell says, and which bricks are stored.
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

}  // namespace kelp::fields

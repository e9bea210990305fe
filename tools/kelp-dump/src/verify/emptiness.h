// SPDX-License-Identifier: MIT
// The boxes that empty voxels' codes and empty bricks' cells promise to be empty (formats/SPEC.md, "Empty
// boxes"): tests a promise, and prints it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "kelp/fields/fields.h"

namespace kelp::dump {

// Whether the box of an empty voxel's code holds a solid voxel.
bool breaksPromise(std::uint8_t code, const glm::ivec3& voxel, const fields::Occupancy& occupancy);

// Whether the box of an empty brick's cell holds a stored brick, or its clearance exceeds the right one. Only
// bit 31 of `cells` matters.
bool breaksPromise(std::uint32_t cell, const glm::ivec3& brick, std::span<const std::uint32_t> cells,
                   const glm::ivec3& grid, int right_clearance);

// "3 x 0 x 7": how far the box reaches both ways.
std::string codeText(std::uint8_t code);
// "0+3 x 4+0 x 15+15 bricks and clearance 12": how far the box reaches down and up.
std::string cellText(std::uint32_t cell);

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
// Empty boxes: how far a ray may go in empty space (formats/SPEC.md, 5.1.1). They are not stored: the
// reader makes them of what it knows.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "kelp/formats/brick.h"
#include "kelp/formats/buffer.h"

namespace kelp {

// Voxels around a brick on each side that matter to the boxes of its voxels: as far as a code reaches.
inline constexpr int kBoxReach = 7;
inline constexpr int kBoxWindow = kBrickSide + 2 * kBoxReach;

// A brick and those around it, a bit a voxel, 1: solid. slices[i][j][z + kBoxReach] is slice z of the brick
// i - 1 along x and j - 1 along y from the middle one: bit x + 8 y, as in BrickBits.
struct BoxWindow {
  std::array<std::array<std::array<std::uint64_t, kBoxWindow>, 3>, 3> slices;
};

// Writes the codes of the empty voxels of the brick in the window's middle, the best of all boxes that hold
// nothing solid of the window; leaves those of the solid ones alone. codes: the brick's 512.
void chooseBoxes(const BoxWindow& window, std::span<std::uint8_t, kBrickVoxels> codes);

// Writes the boxes of the empty bricks into bits 0 to 23 of their cells, and leaves everything else alone.
// cells: one a brick of the grid. False: no memory for 4 bytes a brick.
[[nodiscard]] bool growBoxes(std::span<std::uint32_t> cells, const glm::ivec3& grid,
                             const Allocator& allocator = {});

}  // namespace kelp

// SPDX-License-Identifier: MIT
// Empty boxes: how far a ray may go in empty space. They follow from which voxels are solid, so files do not
// hold them: the reader makes them.
//
// The box of a code around an empty voxel holds the voxels whose distance from it along each axis is at most
// that axis's reach: 0, 1, 3 or 7. Of all boxes without a solid voxel it is the one with the longest shortest
// reach; among equals the longest middle reach, then the longest longest reach, then the lowest code. This
// order is that of the mean steps of a ray. A page knows its own
// bricks to the voxel, and those of other pages as far as the next coarser level: there a box ends up to one
// voxel early.
//
// The box of an empty brick's cell holds the brick and as many bricks beyond it on each of the six sides, at
// most 15. It grows in rounds, side by side, as long as the slab that a side would add holds no solid brick;
// a side that is stopped once stays.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "kelp/formats/brick.h"
#include "kelp/formats/buffer.h"

namespace kelp {

// Voxels around a brick on each side that can change its boxes: a code reaches no farther.
inline constexpr int kBoxReach = 7;
inline constexpr int kBoxWindow = kBrickSide + 2 * kBoxReach;

// A brick and those around it, a bit a voxel, 1: solid. slices[i][j][z + kBoxReach] is slice z of the brick
// i - 1 along x and j - 1 along y from the middle one: bit x + 8 y, as in BrickBits.
struct BoxWindow {
  std::array<std::array<std::array<std::uint64_t, kBoxWindow>, 3>, 3> slices;
};

// Writes the codes of the empty voxels of the brick in the window's middle. Codes of solid voxels stay as
// they are. codes: the brick's 512.
void chooseBoxes(const BoxWindow& window, std::span<std::uint8_t, kBrickVoxels> codes);

// Writes the boxes of the empty bricks into bits 0 to 23 of their cells; all other bits stay as they are.
// cells: one for each brick of the grid. kOutOfMemory: no room for 4 bytes a brick.
Result<void> growBoxes(std::span<std::uint32_t> cells, const glm::ivec3& grid,
                       const Allocator& allocator = {});

}  // namespace kelp

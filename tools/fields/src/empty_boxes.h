// SPDX-License-Identifier: MIT
// The empty boxes that cells and codes promise (formats/SPEC.md, "Empty boxes").
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"

namespace kelp::fields {

// Occupancy at a bit a voxel, with a margin of one empty brick all around.
class SolidBits {
 public:
  SolidBits(const Occupancy& occupancy, int threads);

  // Eight voxels along x: those of brick `brick_x` in row (y, z). -1 <= brick_x <= grid.x, -8 <= y, z < 8
  // (grid + 1).
  std::uint8_t row(int brick_x, int y, int z) const { return bits_[index(brick_x, y, z)]; }
  bool holdsSolid(const glm::ivec3& brick) const;
  bool isFull(const glm::ivec3& brick) const;
  static std::uint64_t bytes(const glm::ivec3& grid);

 private:
  std::size_t index(int brick_x, int y, int z) const {
    return static_cast<std::size_t>(brick_x + 1) +
           width_ * (static_cast<std::size_t>(y + kBrickSide) +
                     height_ * static_cast<std::size_t>(z + kBrickSide));
  }
  std::size_t width_, height_;
  std::vector<std::uint8_t> bits_;
};

// Writes the codes of the empty voxels of a brick; leaves those of the solid ones alone.
void chooseCodes(const SolidBits& bits, const glm::ivec3& brick, std::uint8_t* codes);

// How many bricks of each region of the grid hold something solid.
class BrickSums {
 public:
  BrickSums(const SolidBits& bits, const glm::ivec3& grid);

  // Bits 0 to 23 of the cell of an empty brick.
  std::uint32_t grownBox(const glm::ivec3& brick) const;
  static std::uint64_t bytes(const glm::ivec3& grid);

 private:
  // Bricks in the box from low to high, both included, that hold something; outside the grid there is
  // nothing.
  std::uint32_t count(glm::ivec3 low, glm::ivec3 high) const;
  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(grid_.x + 1) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(grid_.y + 1) * static_cast<std::size_t>(z));
  }
  glm::ivec3 grid_;
  std::vector<std::uint32_t> sums_;  // of all bricks below (x, y, z)
};

}  // namespace kelp::fields

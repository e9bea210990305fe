// SPDX-License-Identifier: MIT
// Occupancy at a bit a voxel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "kelp/fields/fields.h"

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

}  // namespace kelp::fields

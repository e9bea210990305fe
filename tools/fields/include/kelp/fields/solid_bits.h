// SPDX-License-Identifier: MIT
// Occupancy at a bit a voxel: an eighth of the memory where rows are long, and 64 voxels at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace kelp::fields {

struct Occupancy;

// A bit for each voxel of a volume: 1 if it is solid. Rows are whole words, one of them an empty margin, so
// that code which reads a voxel's neighbors needs no checks of bounds; a row takes 16 bytes at least.
// Reading is safe on any number of threads, and so is writing to different rows.
class SolidBits {
 public:
  static constexpr int kWordVoxels = 64;

  // All empty. Throws std::invalid_argument on sizes that fields.h excludes.
  explicit SolidBits(const glm::ivec3& size);
  // Throws std::invalid_argument if the number of values is not the size's.
  SolidBits(const Occupancy& occupancy, int threads);

  const glm::ivec3& size() const { return size_; }
  // The words of a row that hold voxels.
  int words() const { return static_cast<int>(width_) - 1; }

  // Voxel x of row (y, z) is bit x % 64 of word x / 64. Words -1 and words(), and rows from -1 to the end of
  // the last brick and one more, may be read, and are 0. -1 <= y <= 8 brickGrid(size).y, z alike.
  const std::uint64_t* row(int y, int z) const { return bits_.data() + index(y, z); }
  std::uint64_t* row(int y, int z) { return bits_.data() + index(y, z); }
  // Eight voxels along x: those of the brick `brick_x`.
  std::uint8_t eight(int brick_x, int y, int z) const {
    return static_cast<std::uint8_t>(row(y, z)[brick_x / 8] >> (brick_x % 8 * 8));
  }
  bool isSolid(const glm::ivec3& voxel) const {
    return row(voxel.y, voxel.z)[voxel.x / kWordVoxels] >> (voxel.x % kWordVoxels) & 1;
  }

  // Solid voxels.
  std::uint64_t count(int threads) const;

  // Memory of a volume of so many voxels.
  static std::uint64_t bytes(const glm::ivec3& size);

 private:
  std::size_t index(int y, int z) const {
    return 1 + width_ * (static_cast<std::size_t>(y + 1) + height_ * static_cast<std::size_t>(z + 1));
  }
  glm::ivec3 size_;
  std::size_t width_, height_;  // of a row in words, its margin before it; of a slice in rows
  std::vector<std::uint64_t> bits_;
};

}  // namespace kelp::fields

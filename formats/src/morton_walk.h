// SPDX-License-Identifier: MIT
// Walks through the cells of a grid in Morton order, without sorting and without memory.
#pragma once

#include <bit>
#include <cstdint>

#include <glm/vec3.hpp>

namespace kelp {

// for (MortonWalk walk(grid); !walk.done(); walk.next()) use walk.cell();
class MortonWalk {
 public:
  explicit MortonWalk(const glm::ivec3& grid) : grid_(grid) {
    // The bitwise or has the highest bit of the largest coordinate. The walk covers a cube of that side.
    const auto bits = static_cast<int>(
        std::bit_width(static_cast<std::uint32_t>((grid.x - 1) | (grid.y - 1) | (grid.z - 1))));
    end_ = std::uint64_t{1} << (3 * bits);
  }

  bool done() const { return code_ >= end_; }
  const glm::ivec3& cell() const { return cell_; }
  // Index of the cell in an array with x fastest, then y, then z.
  std::uint64_t index() const {
    return static_cast<std::uint64_t>(cell_.x) +
           static_cast<std::uint64_t>(grid_.x) *
               (static_cast<std::uint64_t>(cell_.y) +
                static_cast<std::uint64_t>(grid_.y) * static_cast<std::uint64_t>(cell_.z));
  }

  void next() {
    ++code_;
    while (code_ < end_) {
      cell_ = {compactBits(code_), compactBits(code_ >> 1), compactBits(code_ >> 2)};
      if (cell_.x < grid_.x && cell_.y < grid_.y && cell_.z < grid_.z) return;
      // If the first cell of an aligned block lies beyond the grid, the whole block does.
      code_ += std::uint64_t{1} << (std::countr_zero(code_) / 3 * 3);
    }
  }

 private:
  // Collects bits 0, 3, 6, ... of x.
  static int compactBits(std::uint64_t x) {
    x &= 0x1249249249249249u;
    x = (x | (x >> 2)) & 0x10c30c30c30c30c3u;
    x = (x | (x >> 4)) & 0x100f00f00f00f00fu;
    x = (x | (x >> 8)) & 0x001f0000ff0000ffu;
    x = (x | (x >> 16)) & 0x001f00000000ffffu;
    x = (x | (x >> 32)) & 0x00000000001fffffu;
    return static_cast<int>(x);
  }

  glm::ivec3 grid_;
  glm::ivec3 cell_{0};
  std::uint64_t code_ = 0;
  std::uint64_t end_ = 0;
};

}  // namespace kelp

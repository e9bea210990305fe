// SPDX-License-Identifier: MIT
#include "solid_bits.h"

#include "kelp/formats/brick.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

// Bit i: byte i is not 0.
std::uint8_t bitsOfEight(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  for (int i = 0; i < 8; ++i) word |= std::uint64_t{bytes[i]} << (8 * i);
  constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7fu;
  const std::uint64_t ones = (((word & kLow) + kLow) | word) >> 7 & 0x0101010101010101u;
  return static_cast<std::uint8_t>(ones * 0x0102040810204080u >> 56);  // gathers one bit from each byte
}

}  // namespace

SolidBits::SolidBits(const Occupancy& occupancy, int threads)
    : width_(static_cast<std::size_t>(brickGrid(occupancy.size).x) + 2),
      height_(static_cast<std::size_t>(brickGrid(occupancy.size).y + 2) * kBrickSide),
      bits_(bytes(brickGrid(occupancy.size))) {
  const glm::ivec3 size = occupancy.size;
  parallelFor(size.z, grainOf(std::int64_t{size.x} * size.y), threads,
              [&](std::int64_t begin, std::int64_t end) {
                for (int z = static_cast<int>(begin); z < end; ++z) {
                  for (int y = 0; y < size.y; ++y) {
                    const std::uint8_t* const solid = occupancy.solid.data() + occupancy.index({0, y, z});
                    std::uint8_t* const row = bits_.data() + index(0, y, z);
                    int x = 0;
                    for (; x + kBrickSide <= size.x; x += kBrickSide)
                      row[x / kBrickSide] = bitsOfEight(solid + x);
                    for (; x < size.x; ++x)
                      row[x / kBrickSide] |= static_cast<std::uint8_t>((solid[x] != 0) << (x % kBrickSide));
                  }
                }
              });
}

bool SolidBits::holdsSolid(const glm::ivec3& brick) const {
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      if (row(brick.x, brick.y * kBrickSide + y, brick.z * kBrickSide + z)) return true;
    }
  }
  return false;
}

bool SolidBits::isFull(const glm::ivec3& brick) const {
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      if (row(brick.x, brick.y * kBrickSide + y, brick.z * kBrickSide + z) != 0xff) return false;
    }
  }
  return true;
}

std::uint64_t SolidBits::bytes(const glm::ivec3& grid) {
  return static_cast<std::uint64_t>(grid.x + 2) * static_cast<std::uint64_t>(grid.y + 2) *
         static_cast<std::uint64_t>(grid.z + 2) * kBrickSide * kBrickSide;
}

}  // namespace kelp::fields

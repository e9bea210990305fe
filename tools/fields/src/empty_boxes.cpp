// SPDX-License-Identifier: MIT
#include "empty_boxes.h"

#include <algorithm>
#include <array>
#include <bit>

#include "parallel.h"

namespace kelp::fields {
namespace {

constexpr int kReach = 7;                         // the longest of a code
constexpr int kWindow = kBrickSide + 2 * kReach;  // voxels that matter to a brick's codes, on each axis
constexpr int kReaches = 4;                       // 2^k - 1 for k = 0 .. 3

// The 64 codes, the best first: by the shortest of their three reaches, then the middle one, then the
// longest, then by number.
std::array<std::uint8_t, 64> preferredCodes() {
  std::array<std::uint8_t, 64> codes;
  for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = static_cast<std::uint8_t>(i);
  const auto sorted = [](std::uint8_t code) {
    std::array<int, 3> k{code & 3, code >> 2 & 3, code >> 4};
    std::sort(k.begin(), k.end());
    return k;
  };
  std::stable_sort(codes.begin(), codes.end(),
                   [&](std::uint8_t a, std::uint8_t b) { return sorted(a) > sorted(b); });
  return codes;
}

// The 22 lines of a window -> for k = 0 .. 3, for each of the eight lines in its middle, the union of all
// lines within 2^k - 1 of it. Runs of 2^k lines double from one k to the next, and two of them cover the
// 2^(k+1) - 1 lines around one.
template <class Line>
std::array<std::array<Line, kBrickSide>, kReaches> spread(const std::array<Line, kWindow>& lines) {
  std::array<std::array<Line, kBrickSide>, kReaches> near{};
  std::array<Line, kWindow> run = lines;
  for (std::size_t k = 0; k < kReaches; ++k) {
    const std::size_t length = std::size_t{1} << k;
    for (std::size_t i = 0; i < kBrickSide; ++i)
      near[k][i] = run[i + kReach] | run[i + kReach - (length - 1)];
    for (std::size_t i = 0; i + length < kWindow; ++i) run[i] |= run[i + length];
  }
  return near;
}

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

void chooseCodes(const SolidBits& bits, const glm::ivec3& brick, std::uint8_t* codes) {
  static const std::array<std::uint8_t, 64> preferred = preferredCodes();
  const glm::ivec3 first = brick * kBrickSide - kReach;

  // Which voxels have a solid one in the box of each code: along x by shifts of a row, along y over rows,
  // along z over slices of 64 bits.
  std::array<std::array<std::array<std::uint64_t, kWindow>, kReaches>, kReaches> slices;  // [kx][ky][z]
  for (std::size_t z = 0; z < kWindow; ++z) {
    std::array<std::array<std::uint8_t, kWindow>, kReaches> rows;  // [kx][y]
    for (std::size_t y = 0; y < kWindow; ++y) {
      // bit i: a solid voxel among the 2^k from i on; the brick's own row begins at bit 8
      std::uint32_t run = 0;
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t eight =
            bits.row(brick.x - 1 + i, first.y + static_cast<int>(y), first.z + static_cast<int>(z));
        run |= eight << (kBrickSide * i);
      }
      for (std::size_t k = 0; k < kReaches; ++k) {
        const int length = 1 << k;
        rows[k][y] = static_cast<std::uint8_t>((run | run << (length - 1)) >> kBrickSide);
        run |= run >> length;
      }
    }
    for (std::size_t kx = 0; kx < kReaches; ++kx) {
      const auto near = spread(rows[kx]);
      for (std::size_t ky = 0; ky < kReaches; ++ky) {
        std::uint64_t slice = 0;
        for (std::size_t y = 0; y < kBrickSide; ++y) slice |= std::uint64_t{near[ky][y]} << (8 * y);
        slices[kx][ky][z] = slice;
      }
    }
  }
  std::array<std::array<std::uint64_t, kBrickSide>, 64> blocked;
  for (std::size_t kx = 0; kx < kReaches; ++kx) {
    for (std::size_t ky = 0; ky < kReaches; ++ky) {
      const auto near = spread(slices[kx][ky]);
      for (std::size_t kz = 0; kz < kReaches; ++kz) blocked[kx | ky << 2 | kz << 4] = near[kz];
    }
  }

  std::array<std::uint64_t, kBrickSide> open = blocked[0];
  for (std::uint64_t& slice : open) slice = ~slice;
  for (const std::uint8_t code : preferred) {
    for (std::size_t z = 0; z < kBrickSide; ++z) {
      std::uint64_t fits = open[z] & ~blocked[code][z];
      open[z] ^= fits;
      for (; fits != 0; fits &= fits - 1)
        codes[64 * z + static_cast<std::size_t>(std::countr_zero(fits))] = code;
    }
  }
}

BrickSums::BrickSums(const SolidBits& bits, const glm::ivec3& grid)
    : grid_(grid), sums_(bytes(grid) / sizeof(std::uint32_t)) {
  for (int z = 0; z < grid.z; ++z) {
    for (int y = 0; y < grid.y; ++y) {
      std::uint32_t row = 0;
      for (int x = 0; x < grid.x; ++x) {
        row += bits.holdsSolid({x, y, z});
        sums_[index(x + 1, y + 1, z + 1)] =
            row + sums_[index(x + 1, y, z + 1)] + sums_[index(x + 1, y + 1, z)] - sums_[index(x + 1, y, z)];
      }
    }
  }
}

std::uint64_t BrickSums::bytes(const glm::ivec3& grid) {
  return static_cast<std::uint64_t>(grid.x + 1) * static_cast<std::uint64_t>(grid.y + 1) *
         static_cast<std::uint64_t>(grid.z + 1) * sizeof(std::uint32_t);
}

std::uint32_t BrickSums::count(glm::ivec3 low, glm::ivec3 high) const {
  low = glm::max(low, glm::ivec3(0));
  high = glm::min(high + 1, grid_);
  if (low.x >= high.x || low.y >= high.y || low.z >= high.z) return 0;
  const auto plane = [&](int z) {
    return sums_[index(high.x, high.y, z)] - sums_[index(low.x, high.y, z)] - sums_[index(high.x, low.y, z)] +
           sums_[index(low.x, low.y, z)];
  };
  return plane(high.z) - plane(low.z);
}

std::uint32_t BrickSums::grownBox(const glm::ivec3& brick) const {
  // as most are in a large volume
  if (count(brick - kCellMaxReach, brick + kCellMaxReach) == 0) return 0xffffff;
  glm::ivec3 low = brick, high = brick;
  std::array<int, 6> reach{};
  std::array<bool, 6> grows;
  grows.fill(true);
  // A slab only widens while the other sides grow: a side that cannot move once never will.
  while (std::find(grows.begin(), grows.end(), true) != grows.end()) {
    for (int side = 0; side < 6; ++side) {
      const auto s = static_cast<std::size_t>(side);
      if (!grows[s]) continue;
      const int axis = side / 2;
      glm::ivec3 from = low, to = high;  // the slab of bricks beyond this side
      from[axis] = to[axis] = side % 2 == 0 ? low[axis] - 1 : high[axis] + 1;
      grows[s] = reach[s] < kCellMaxReach && count(from, to) == 0;
      if (!grows[s]) continue;
      ++reach[s];
      low = glm::min(low, from);
      high = glm::max(high, to);
    }
  }
  std::uint32_t box = 0;
  for (std::size_t side = 0; side < 6; ++side) box |= static_cast<std::uint32_t>(reach[side]) << (4 * side);
  return box;
}

}  // namespace kelp::fields

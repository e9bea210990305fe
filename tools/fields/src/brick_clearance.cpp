// SPDX-License-Identifier: MIT
#include "brick_clearance.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "parallel.h"

// A distance transform on a lattice that is coarse where the answer is: squared distances between boxes are
// sums over axes, so the axes come one after the other, each turning voxels into bricks: rows of bits ->
// bricks along x, voxels along y and z -> bricks along x and y, voxels along z -> bricks. What is farther
// than a cell can say counts as as far as that, so 15 bits do, and the search along y and z ends early.

namespace kelp::fields {
namespace {

constexpr int kFar = 128;  // beyond kCellMaxClearance, and its square plus that of any gap fits
static_assert(kFar > static_cast<int>(kCellMaxClearance) && 2 * kFar * kFar <= 32768);
using Square = std::int16_t;
constexpr Square kFarSquare = kFar * kFar - 1;

// The squared gaps along x from each brick of a row to the nearest solid voxel of the row.
void gapsOfRow(const SolidBits& bits, int bricks, int y, int z, Square* squares) {
  int gap = kFar;  // from the end of the brick before to the solid voxel before it
  for (int x = 0; x < bricks; ++x) {
    const std::uint8_t eight = bits.row(x, y, z);
    squares[x] = static_cast<Square>(eight ? 0 : gap);
    gap = eight ? std::countl_zero(eight) : std::min(gap + kBrickSide, kFar);
  }
  gap = kFar;
  for (int x = bricks - 1; x >= 0; --x) {
    const std::uint8_t eight = bits.row(x, y, z);
    const int nearest = std::min<int>(squares[x], gap);
    squares[x] = nearest == kFar ? kFarSquare : static_cast<Square>(nearest * nearest);
    gap = eight ? std::countr_zero(eight) : std::min(gap + kBrickSide, kFar);
  }
}

void lower(Square* best, const Square* line, Square add, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    best[i] = std::min<Square>(best[i], static_cast<Square>(line[i] + add));
}
bool allAtMost(const Square* best, Square enough, std::size_t count) {
  Square most = 0;
  for (std::size_t i = 0; i < count; ++i) most = std::max(most, best[i]);
  return most <= enough;
}

// From `lines` lines of `count` values, a line a voxel along an axis, to one line for each brick along it:
// the least of value + gap^2.
void reduceAxis(const Square* from, std::size_t stride, int lines, std::size_t count, Square* to,
                std::size_t to_stride) {
  const auto line = [&](int i) { return from + static_cast<std::size_t>(i) * stride; };
  for (int brick = 0; brick < lines / kBrickSide; ++brick) {
    Square* const best = to + static_cast<std::size_t>(brick) * to_stride;
    const int first = brick * kBrickSide, end = first + kBrickSide;
    std::copy_n(line(first), count, best);
    for (int i = first + 1; i < end; ++i) lower(best, line(i), 0, count);
    for (int gap = 0; gap < kFar; ++gap) {
      const auto square = static_cast<Square>(gap * gap);
      const bool below = first - 1 - gap >= 0, above = end + gap < lines;
      if ((!below && !above) || allAtMost(best, square, count)) break;
      if (below) lower(best, line(first - 1 - gap), square, count);
      if (above) lower(best, line(end + gap), square, count);
    }
  }
}

std::size_t sliceOf(const glm::ivec3& grid) {
  return static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y);
}

}  // namespace

std::vector<std::uint8_t> brickClearances(const SolidBits& bits, const glm::ivec3& grid, int threads) {
  const auto width = static_cast<std::size_t>(grid.x);
  const std::size_t slice = sliceOf(grid);
  const int height = grid.y * kBrickSide, depth = grid.z * kBrickSide;
  // bricks along x and y, voxels along z
  std::vector<Square> slices(slice * static_cast<std::size_t>(depth));
  parallelFor(depth, grainOf(std::int64_t{grid.x} * height), threads,
              [&](std::int64_t begin, std::int64_t end) {
                std::vector<Square> rows(width * static_cast<std::size_t>(height));
                for (auto z = static_cast<int>(begin); z < end; ++z) {
                  for (int y = 0; y < height; ++y)
                    gapsOfRow(bits, grid.x, y, z, rows.data() + width * static_cast<std::size_t>(y));
                  reduceAxis(rows.data(), width, height, width,
                             slices.data() + slice * static_cast<std::size_t>(z), width);
                }
              });
  std::vector<std::uint8_t> clearances(slice * static_cast<std::size_t>(grid.z));
  parallelFor(
      grid.y, grainOf(std::int64_t{grid.x} * depth), threads, [&](std::int64_t begin, std::int64_t end) {
        std::vector<Square> best(width * static_cast<std::size_t>(grid.z));
        for (auto y = static_cast<std::size_t>(begin); y < static_cast<std::size_t>(end); ++y) {
          reduceAxis(slices.data() + width * y, slice, depth, width, best.data(), width);
          for (std::size_t z = 0; z < static_cast<std::size_t>(grid.z); ++z) {
            for (std::size_t x = 0; x < width; ++x) {
              const auto square = static_cast<std::uint32_t>(best[width * z + x]);
              clearances[slice * z + width * y + x] =
                  static_cast<std::uint8_t>(std::min(quantizedClearance(square, 1), kCellMaxClearance));
            }
          }
        }
      });
  return clearances;
}

std::uint64_t brickClearanceBytes(const glm::ivec3& grid) {
  return sliceOf(grid) * static_cast<std::uint64_t>(grid.z) * (kBrickSide * sizeof(Square) + 1);
}

}  // namespace kelp::fields

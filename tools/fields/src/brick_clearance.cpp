// SPDX-License-Identifier: MIT
#include "bricks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
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
    const std::uint8_t eight = bits.eight(x, y, z);
    squares[x] = static_cast<Square>(eight ? 0 : gap);
    gap = eight ? std::countl_zero(eight) : std::min(gap + kBrickSide, kFar);
  }
  gap = kFar;
  for (int x = bricks - 1; x >= 0; --x) {
    const std::uint8_t eight = bits.eight(x, y, z);
    const int nearest = std::min<int>(squares[x], gap);
    squares[x] = nearest == kFar ? kFarSquare : static_cast<Square>(nearest * nearest);
    gap = eight ? std::countr_zero(eight) : std::min(gap + kBrickSide, kFar);
  }
}

// Lines and their results.
struct Axis {
  const Square* from;
  std::size_t stride;  // from line to line
  int lines;
  Square* to;
  std::size_t to_stride;
};

// From lines across an axis, one a voxel along it, to one line for each brick: the least of value + gap^2. Of
// kLanes values side by side, from `at` on, so that the least ones stay in registers.
template <std::size_t kLanes>
void reduceLanes(const Axis& axis, std::size_t at) {
  std::array<Square, kLanes> best;
  const auto lower = [&](int i, Square square) {
    const Square* const line = axis.from + static_cast<std::size_t>(i) * axis.stride + at;
    for (std::size_t k = 0; k < kLanes; ++k)
      best[k] = std::min<Square>(best[k], static_cast<Square>(line[k] + square));
  };
  const auto allAtMost = [&](Square enough) {
    Square most = 0;
    for (std::size_t k = 0; k < kLanes; ++k) most = std::max(most, best[k]);
    return most <= enough;
  };
  Square* to = axis.to + at;
  for (int brick = 0; brick < axis.lines / kBrickSide; ++brick, to += axis.to_stride) {
    const int first = brick * kBrickSide, end = first + kBrickSide;
    best.fill(kFarSquare);
    for (int i = first; i < end; ++i) lower(i, 0);
    for (int gap = 0; gap < kFar && (first - 1 - gap >= 0 || end + gap < axis.lines); ++gap) {
      const auto square = static_cast<Square>(gap * gap);
      if (gap % 4 == 0 && allAtMost(square)) break;
      if (first - 1 - gap >= 0) lower(first - 1 - gap, square);
      if (end + gap < axis.lines) lower(end + gap, square);
    }
    std::copy(best.begin(), best.end(), to);
  }
}

// `count` is a multiple of kFewLanes.
constexpr std::size_t kLanes = 32, kFewLanes = 8;
void reduceAxis(const Axis& axis, std::size_t count) {
  std::size_t at = 0;
  for (; at + kLanes <= count; at += kLanes) reduceLanes<kLanes>(axis, at);
  for (; at < count; at += kFewLanes) reduceLanes<kFewLanes>(axis, at);
}

std::size_t paddedWidth(const glm::ivec3& grid) {
  return (static_cast<std::size_t>(grid.x) + kFewLanes - 1) / kFewLanes * kFewLanes;
}

}  // namespace

std::vector<std::uint8_t> brickClearances(const SolidBits& bits, int threads) {
  const glm::ivec3 grid = brickGrid(bits.size());
  const std::size_t width = paddedWidth(grid), slice = width * static_cast<std::size_t>(grid.y);
  const int height = grid.y * kBrickSide, depth = grid.z * kBrickSide;
  // bricks along x and y, voxels along z
  std::vector<Square> slices(slice * static_cast<std::size_t>(depth));
  parallelFor(
      depth, grainOf(std::int64_t{grid.x} * height), threads, [&](std::int64_t begin, std::int64_t end) {
        // Beside the grid zeros, which let a search end.
        std::vector<Square> rows(width * static_cast<std::size_t>(height));
        for (auto z = static_cast<int>(begin); z < end; ++z) {
          for (int y = 0; y < height; ++y)
            gapsOfRow(bits, grid.x, y, z, rows.data() + width * static_cast<std::size_t>(y));
          reduceAxis({rows.data(), width, height, slices.data() + slice * static_cast<std::size_t>(z), width},
                     width);
        }
      });
  std::vector<std::uint8_t> clearances(denseCount(grid));
  parallelFor(
      grid.y, grainOf(std::int64_t{grid.x} * depth), threads, [&](std::int64_t begin, std::int64_t end) {
        std::vector<Square> best(width * static_cast<std::size_t>(grid.z));
        for (int y = static_cast<int>(begin); y < end; ++y) {
          reduceAxis({slices.data() + width * static_cast<std::size_t>(y), slice, depth, best.data(), width},
                     width);
          for (int z = 0; z < grid.z; ++z) {
            const Square* const line = best.data() + width * static_cast<std::size_t>(z);
            std::uint8_t* const out = &clearances[denseIndex(grid, 0, y, z)];
            for (int x = 0; x < grid.x; ++x)
              out[x] = static_cast<std::uint8_t>(
                  std::min<double>(std::sqrt(static_cast<double>(line[x])), kCellMaxClearance));
          }
        }
      });
  return clearances;
}

std::uint64_t brickClearanceBytes(const glm::ivec3& grid) {
  constexpr std::uint64_t kThreads =
      8;  // which hold the rows of a slice each; more hold little beside the rest
  const std::uint64_t row = paddedWidth(grid) * sizeof(Square),
                      slice = row * static_cast<std::uint64_t>(grid.y);
  return slice * kBrickSide * (static_cast<std::uint64_t>(grid.z) + kThreads) + denseCount(grid);
}

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
#include "brick_clearance.h"

#include <algorithm>
#include <array>
#include <bit>
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

// As many values as are treated side by side, so that the least ones stay in registers.
constexpr int kLanes = 32;

// From `lines` lines of `count` values, a line a voxel along an axis, to one line for each brick along it:
// the least of value + gap^2. `count` is a multiple of kLanes.
void reduceAxis(const Square* from, std::size_t stride, int lines, std::size_t count, Square* to,
                std::size_t to_stride) {
  std::array<Square, kLanes> best;
  const auto lower = [&](std::size_t at, int i, Square square) {
    const Square* const line = from + static_cast<std::size_t>(i) * stride + at;
    for (std::size_t k = 0; k < kLanes; ++k)
      best[k] = std::min<Square>(best[k], static_cast<Square>(line[k] + square));
  };
  const auto allAtMost = [&](Square enough) {
    Square most = 0;
    for (std::size_t k = 0; k < kLanes; ++k) most = std::max(most, best[k]);
    return most <= enough;
  };
  for (int brick = 0; brick < lines / kBrickSide; ++brick, to += to_stride) {
    const int first = brick * kBrickSide, end = first + kBrickSide;
    for (std::size_t at = 0; at < count; at += kLanes) {
      best.fill(kFarSquare);
      for (int i = first; i < end; ++i) lower(at, i, 0);
      for (int gap = 0; gap < kFar && (first - 1 - gap >= 0 || end + gap < lines); ++gap) {
        const auto square = static_cast<Square>(gap * gap);
        if (gap % 4 == 0 && allAtMost(square)) break;
        if (first - 1 - gap >= 0) lower(at, first - 1 - gap, square);
        if (end + gap < lines) lower(at, end + gap, square);
      }
      std::copy(best.begin(), best.end(), to + at);
    }
  }
}

std::size_t paddedWidth(const glm::ivec3& grid) {
  return static_cast<std::size_t>((grid.x + kLanes - 1) / kLanes * kLanes);
}

}  // namespace

std::vector<std::uint8_t> brickClearances(const SolidBits& bits, int threads) {
  const glm::ivec3 grid = brickGrid(bits.size());
  const std::size_t width = paddedWidth(grid), slice = width * static_cast<std::size_t>(grid.y);
  const int height = grid.y * kBrickSide, depth = grid.z * kBrickSide;
  // bricks along x and y, voxels along z
  std::vector<Square> slices(slice * static_cast<std::size_t>(depth));
  parallelFor(depth, grainOf(std::int64_t{grid.x} * height), threads,
              [&](std::int64_t begin, std::int64_t end) {
                // Beside the grid zeros, which let a search end.
                std::vector<Square> rows(width * static_cast<std::size_t>(height));
                for (auto z = static_cast<int>(begin); z < end; ++z) {
                  for (int y = 0; y < height; ++y)
                    gapsOfRow(bits, grid.x, y, z, rows.data() + width * static_cast<std::size_t>(y));
                  reduceAxis(rows.data(), width, height, width,
                             slices.data() + slice * static_cast<std::size_t>(z), width);
                }
              });
  std::vector<std::uint8_t> clearances(denseCount(grid));
  parallelFor(
      grid.y, grainOf(std::int64_t{grid.x} * depth), threads, [&](std::int64_t begin, std::int64_t end) {
        std::vector<Square> best(width * static_cast<std::size_t>(grid.z));
        for (int y = static_cast<int>(begin); y < end; ++y) {
          reduceAxis(slices.data() + width * static_cast<std::size_t>(y), slice, depth, width, best.data(),
                     width);
          for (int z = 0; z < grid.z; ++z) {
            const Square* const line = best.data() + width * static_cast<std::size_t>(z);
            std::uint8_t* const out = &clearances[denseIndex(grid, 0, y, z)];
            for (int x = 0; x < grid.x; ++x)
              out[x] = static_cast<std::uint8_t>(
                  std::min(quantizedClearance(static_cast<std::uint32_t>(line[x]), 1), kCellMaxClearance));
          }
        }
      });
  return clearances;
}

std::uint64_t brickClearanceBytes(const glm::ivec3& grid) {
  return static_cast<std::uint64_t>(grid.z) *
             (paddedWidth(grid) * static_cast<std::uint64_t>(grid.y) * kBrickSide * sizeof(Square)) +
         denseCount(grid);
}

}  // namespace kelp::fields

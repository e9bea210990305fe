// SPDX-License-Identifier: MIT
// Exact squared distances within a band, brick by brick: separable minima over a window of bits, as wide as
// the band on every side. Along x a distance is a count of zero bits; along y and z eight voxels of a row go
// side by side through the minima.
#include "kelp/formats/distance.h"

#include <algorithm>
#include <array>
#include <bit>

namespace kelp {
namespace {

constexpr int kMaxReach = 15;  // floor(sqrt(225))
constexpr int kMaxWindow = kBrickSide + 2 * kMaxReach;
constexpr std::int16_t kNone = 8192;  // above every sum of three squares in the band, and sums fit 16 bits

using Row = std::array<std::int16_t, kBrickSide>;

int reachOf(int squared) {
  int reach = 0;
  while ((reach + 1) * (reach + 1) <= squared) ++reach;
  return reach;
}

// The squared distances along x from the eight voxels in the middle of a row to its nearest set bit.
void measureRow(std::uint64_t bits, int reach, Row& out) {
  for (int x = 0; x < kBrickSide; ++x) {
    const int right = std::countr_zero(bits >> (x + reach));
    const int left = std::countl_zero(bits << (63 - x - reach));
    const int distance = std::min(left, right);
    out[static_cast<std::size_t>(x)] =
        static_cast<std::int16_t>(distance <= reach ? distance * distance : kNone);
  }
}

// The least of row + distance^2 over the rows before and after, `step` rows apart.
Row leastAround(const Row* rows, int step, int reach) {
  Row least;
  least.fill(kNone);
  for (int d = -reach; d <= reach; ++d) {
    const Row& row = rows[(d + reach) * step];
    const auto squared = static_cast<std::int16_t>(d * d);
    for (std::size_t x = 0; x < kBrickSide; ++x)
      least[x] = std::min(least[x], static_cast<std::int16_t>(row[x] + squared));
  }
  return least;
}

// Squared distances from the voxels of the brick in the middle to the nearest voxel of one kind; kNone and
// more: farther than `reach` along an axis.
class Field {
 public:
  // solid: to solid voxels, else to empty ones.
  Field(std::span<const BrickBits* const, 125> around, bool solid, int reach) {
    const int window = kBrickSide + 2 * reach;
    std::array<bool, kMaxWindow> any{};
    for (int z = 0; z < window; ++z) {
      for (int y = 0; y < window; ++y) {
        const std::uint64_t bits = rowBits(around, solid, y - reach, z - reach) >> (16 - reach);
        Row& row = along_x_[static_cast<std::size_t>(z * kMaxWindow + y)];
        measureRow(bits, reach, row);
        any[static_cast<std::size_t>(z)] |= bits != 0;
      }
    }
    for (int z = 0; z < window; ++z) {
      for (int y = 0; y < kBrickSide; ++y) {
        Row& row = along_y_[static_cast<std::size_t>(z * kBrickSide + y)];
        if (any[static_cast<std::size_t>(z)])
          row = leastAround(&along_x_[static_cast<std::size_t>(z * kMaxWindow + y)], 1, reach);
        else
          row.fill(kNone);
      }
    }
    for (int z = 0; z < kBrickSide; ++z)
      for (int y = 0; y < kBrickSide; ++y)
        squared_[static_cast<std::size_t>(y + kBrickSide * z)] =
            leastAround(&along_y_[static_cast<std::size_t>(z * kBrickSide + y)], kBrickSide, reach);
  }

  int squared(std::size_t voxel) const { return squared_[voxel / kBrickSide][voxel % kBrickSide]; }

 private:
  // Forty voxels along x, from two bricks before the middle one on.
  static std::uint64_t rowBits(std::span<const BrickBits* const, 125> around, bool solid, int y, int z) {
    const std::size_t first = 5 * static_cast<std::size_t>((y + 16) / 8 + 5 * ((z + 16) / 8));
    std::uint64_t row = 0;
    for (std::size_t i = 0; i < 5; ++i) {
      const BrickBits* const brick = around[first + i];
      if (!brick) continue;
      const std::uint64_t slice = brick->slices[z & 7] >> (8 * (y & 7)) & 0xff;
      row |= (solid ? slice : slice ^ 0xff) << (8 * i);
    }
    return row;
  }

  std::array<Row, kMaxWindow * kMaxWindow> along_x_;
  std::array<Row, kMaxWindow * kBrickSide> along_y_;
  std::array<Row, kBrickSide * kBrickSide> squared_;
};

}  // namespace

int distanceLevels(const glm::ivec3& size, int levels) {
  int count = 1;
  for (int side = std::max({size.x, size.y, size.z}); side > kBrickSide; side = (side + 1) / 2) ++count;
  return std::max(count, levels);
}

DistanceBand distanceBand(const glm::ivec3& size, int levels, int level) {
  return level + 1 == distanceLevels(size, levels) ? kWidestBand : DistanceBand();
}

void computeDistanceCodes(std::span<const BrickBits* const, 125> around, DistanceBand band,
                          std::span<std::uint8_t, kBrickVoxels> codes) {
  const BrickBits& middle = *around[62];
  const auto solid = [&](std::size_t voxel) { return middle.slices[voxel / 64] >> (voxel % 64) & 1; };
  const auto all = [&](std::uint64_t slice) {
    return std::all_of(std::begin(middle.slices), std::end(middle.slices),
                       [&](std::uint64_t s) { return s == slice; });
  };
  if (!all(~std::uint64_t{0})) {
    const Field to_solid(around, true, reachOf(band.outside));
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const int squared = to_solid.squared(i);
      if (!solid(i)) codes[i] = static_cast<std::uint8_t>(squared <= band.outside ? squared : kFarOutside);
    }
  }
  if (!all(0)) {
    const Field to_empty(around, false, reachOf(band.inside));
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const int squared = to_empty.squared(i);
      if (solid(i)) codes[i] = static_cast<std::uint8_t>(squared <= band.inside ? 255 - squared : kFarInside);
    }
  }
}

}  // namespace kelp

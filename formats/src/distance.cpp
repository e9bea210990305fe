// SPDX-License-Identifier: MIT
// Exact squared distances within a band, brick by brick: separable minima over a window of bits, as wide as
// the band on every side. Along x a distance is a count of zero bits; along y and z the 64 voxels of a slice
// go side by side through the minima, a byte each.
#include "kelp/formats/distance.h"

#include <algorithm>
#include <array>
#include <bit>

namespace kelp {
namespace {

constexpr int kMaxReach = 15;  // floor(sqrt(225))
constexpr int kMaxWindow = kBrickSide + 2 * kMaxReach;
constexpr std::size_t kSlice = kBrickSide * kBrickSide;
constexpr std::uint8_t kNone = 255;  // above every band; sums saturate at it

int reachOf(int squared) {
  int reach = 0;
  while ((reach + 1) * (reach + 1) <= squared) ++reach;
  return reach;
}

// The squared distances along x from the eight voxels in the middle of a row to its nearest set bit.
void measureRow(std::uint64_t bits, int reach, std::uint8_t* out) {
  for (int x = 0; x < kBrickSide; ++x) {
    const int right = std::countr_zero(bits >> (x + reach));
    const int left = std::countl_zero(bits << (63 - x - reach));
    const int distance = std::min(left, right);
    out[x] = static_cast<std::uint8_t>(distance <= reach ? distance * distance : kNone);
  }
}

// least = min(least, values + squared), value by value, saturating. Written so that compilers make vectors of
// it.
void takeLesser(const std::uint8_t* __restrict values, std::uint8_t squared, std::uint8_t* __restrict least) {
  const auto room = static_cast<std::uint8_t>(kNone - squared);
  for (std::size_t i = 0; i < kSlice; ++i) {
    const std::uint8_t value = values[i] < room ? values[i] : room;
    const auto sum = static_cast<std::uint8_t>(value + squared);
    least[i] = sum < least[i] ? sum : least[i];
  }
}

// The least of values + distance^2 over 2 reach + 1 slices of 64 values, `step` apart.
void leastAround(const std::uint8_t* values, std::size_t step, int reach, std::uint8_t* least) {
  std::fill_n(least, kSlice, kNone);
  for (int d = -reach; d <= reach; ++d, values += step)
    takeLesser(values, static_cast<std::uint8_t>(d * d), least);
}

// Squared distances from the voxels of the brick in the middle to the nearest voxel of one kind; kNone:
// beyond the band. solid: to solid voxels, else to empty ones.
class Field {
 public:
  Field(std::span<const BrickBits* const, 125> around, bool solid, int reach) {
    const int window = kBrickSide + 2 * reach;
    std::array<std::uint8_t, kMaxWindow * kBrickSide> along_x;  // of one slice: [y][x]
    std::array<std::uint8_t, kMaxWindow * kSlice> along_y;      // [z][y][x]
    for (int z = 0; z < window; ++z) {
      // Neighbouring rows are often alike.
      const std::array<std::uint64_t, 40> rows = rowsOf(around, solid, reach, z - reach);
      std::uint64_t any = 0, last = 0;
      std::fill_n(along_x.begin(), kBrickSide, kNone);
      for (int y = 0; y < window; ++y) {
        const std::uint64_t bits = rows[static_cast<std::size_t>(y - reach + 16)] >> (16 - reach);
        std::uint8_t* const row = along_x.data() + y * kBrickSide;
        if (bits != last)
          measureRow(bits, reach, row);
        else if (y > 0)
          std::copy_n(row - kBrickSide, kBrickSide, row);
        last = bits;
        any |= bits;
      }
      std::uint8_t* const slice = along_y.data() + static_cast<std::size_t>(z) * kSlice;
      if (any)
        leastAround(along_x.data(), kBrickSide, reach, slice);
      else
        std::fill_n(slice, kSlice, kNone);
    }
    for (std::size_t z = 0; z < kBrickSide; ++z)
      leastAround(along_y.data() + z * kSlice, kSlice, reach, squared_.data() + z * kSlice);
  }

  int squared(std::size_t voxel) const { return squared_[voxel]; }

 private:
  // The rows of a slice, of forty voxels along x each, as far as the reach goes. Both begin two bricks before
  // the middle one.
  static std::array<std::uint64_t, 40> rowsOf(std::span<const BrickBits* const, 125> around, bool solid,
                                              int reach, int z) {
    std::array<std::uint64_t, 40> rows{};
    const std::size_t first = static_cast<std::size_t>(16 - reach) / 8,
                      last = static_cast<std::size_t>(23 + reach) / 8;
    for (std::size_t j = first; j <= last; ++j) {
      for (std::size_t i = first; i <= last; ++i) {
        const BrickBits* const brick = around[i + 5 * (j + 5 * (static_cast<std::size_t>(z + 16) / 8))];
        if (!brick) continue;
        const std::uint64_t slice = solid ? brick->slices[z & 7] : ~brick->slices[z & 7];
        for (std::size_t y = 0; y < kBrickSide; ++y)
          rows[kBrickSide * j + y] |= (slice >> (kBrickSide * y) & 0xff) << (kBrickSide * i);
      }
    }
    return rows;
  }

  std::array<std::uint8_t, kBrickVoxels> squared_;
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

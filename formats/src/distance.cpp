// SPDX-License-Identifier: MIT
// Exact squared distances within a band, brick by brick: separable minima over a window of bits, as wide as
// the band on every side. Along x tables answer for eight voxels at once; along y and z the 64 voxels of a
// slice go side by side through the minima, a byte each.
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

using Eight = std::array<std::uint8_t, kBrickSide>;

// Squared distances along x of eight voxels to the nearest set one among them, by their bits.
constexpr std::array<Eight, 256> kFromMiddle = [] {
  std::array<Eight, 256> table{};
  for (std::size_t bits = 0; bits < table.size(); ++bits) {
    for (int x = 0; x < kBrickSide; ++x) {
      int least = kNone;
      for (int i = 0; i < kBrickSide; ++i)
        if (bits >> i & 1) least = std::min(least, (i - x) * (i - x));
      table[bits][static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(least);
    }
  }
  return table;
}();
// Squared distances along x of eight voxels to a set voxel before them. The index is the number of empty
// voxels between; kMaxReach stands for no set voxel.
constexpr std::array<Eight, kMaxReach + 1> kFromBeside = [] {
  std::array<Eight, kMaxReach + 1> table{};
  for (int gap = 0; gap <= kMaxReach; ++gap)
    for (int x = 0; x < kBrickSide; ++x) {
      const int distance = gap + 1 + x;
      table[static_cast<std::size_t>(gap)][static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(gap < kMaxReach && distance <= kMaxReach ? distance * distance : kNone);
    }
  return table;
}();

// The squared distances along x from the eight voxels in the middle of a row to its nearest set bit: bit
// kMargin is the first of the eight. Bits farther away than the reach are 0.
constexpr int kMargin = 16;
void measureRow(std::uint64_t bits, std::uint8_t* out) {
  const std::uint64_t before = bits & ((1u << kMargin) - 1), after = bits >> (kMargin + kBrickSide);
  const Eight& middle = kFromMiddle[bits >> kMargin & 0xff];
  const Eight& right =
      kFromBeside[after ? static_cast<std::size_t>(std::countr_zero(after)) : std::size_t{kMaxReach}];
  const Eight& left = kFromBeside[before ? static_cast<std::size_t>(kMargin - std::bit_width(before))
                                         : std::size_t{kMaxReach}];
  for (std::size_t x = 0; x < kBrickSide; ++x)
    out[x] = std::min({middle[x], left[x], right[kBrickSide - 1 - x]});
}

// least = min(least, before + squared, after + squared), value by value, saturating. Written so that
// compilers make vectors of it.
void takeLesser(const std::uint8_t* __restrict before, const std::uint8_t* __restrict after,
                std::uint8_t squared, std::uint8_t* __restrict least) {
  const auto room = static_cast<std::uint8_t>(kNone - squared);
  for (std::size_t i = 0; i < kSlice; ++i) {
    std::uint8_t value = before[i] < after[i] ? before[i] : after[i];
    value = value < room ? value : room;
    const auto sum = static_cast<std::uint8_t>(value + squared);
    least[i] = sum < least[i] ? sum : least[i];
  }
}

// The least of values + distance^2 over the slices of 64 values within the reach of the middle one, `step`
// apart.
void leastAround(const std::uint8_t* middle, std::size_t step, int reach, std::uint8_t* least) {
  std::copy_n(middle, kSlice, least);
  const std::uint8_t *before = middle, *after = middle;
  for (int d = 1; d <= reach; ++d) {
    before -= step;
    after += step;
    takeLesser(before, after, static_cast<std::uint8_t>(d * d), least);
  }
}

// Squared distances from the voxels of the brick in the middle to the nearest voxel of one kind; kNone:
// beyond the band. solid: to solid voxels, else to empty ones.
class Field {
 public:
  Field(std::span<const BrickBits* const, 125> around, bool solid, int reach) {
    const int window = kBrickSide + 2 * reach;
    const auto middle = static_cast<std::size_t>(reach);
    std::array<std::uint8_t, kMaxWindow * kBrickSide> along_x;  // of one slice: [y][x]
    std::array<std::uint8_t, kMaxWindow * kSlice> along_y;      // [z][y][x]
    const std::uint64_t within = ((std::uint64_t{1} << window) - 1) << (kMargin - reach);
    for (int z = 0; z < window; ++z) {
      std::array<std::uint64_t, 40> rows;
      std::uint8_t* const slice = along_y.data() + static_cast<std::size_t>(z) * kSlice;
      if (!findRows(around, solid, reach, z - reach, rows)) {
        std::fill_n(slice, kSlice, kNone);
        continue;
      }
      for (int y = 0; y < window; ++y)
        measureRow(rows[static_cast<std::size_t>(y - reach + kMargin)] & within,
                   along_x.data() + y * kBrickSide);
      leastAround(along_x.data() + middle * kBrickSide, kBrickSide, reach, slice);
    }
    for (std::size_t z = 0; z < kBrickSide; ++z)
      leastAround(along_y.data() + (middle + z) * kSlice, kSlice, reach, squared_.data() + z * kSlice);
  }

  const std::uint8_t* slice(std::size_t z) const { return squared_.data() + z * kSlice; }

 private:
  // The rows of a slice, of forty voxels along x each, as far as the reach goes. Both begin two bricks before
  // the middle one. False: all are 0.
  static bool findRows(std::span<const BrickBits* const, 125> around, bool solid, int reach, int z,
                       std::array<std::uint64_t, 40>& rows) {
    const std::size_t first = static_cast<std::size_t>(kMargin - reach) / kBrickSide,
                      last = static_cast<std::size_t>(kMargin + kBrickSide - 1 + reach) / kBrickSide;
    std::fill(rows.begin() + static_cast<std::ptrdiff_t>(kBrickSide * first),
              rows.begin() + static_cast<std::ptrdiff_t>(kBrickSide * (last + 1)), 0);
    bool any = false;
    for (std::size_t j = first; j <= last; ++j) {
      for (std::size_t i = first; i <= last; ++i) {
        const BrickBits* const brick = around[i + 5 * (j + 5 * (static_cast<std::size_t>(z + kMargin) / 8))];
        if (!brick) continue;
        const std::uint64_t slice = solid ? brick->slices[z & 7] : ~brick->slices[z & 7];
        if (slice == 0) continue;
        any = true;
        for (std::size_t y = 0; y < kBrickSide; ++y)
          rows[kBrickSide * j + y] |= (slice >> (kBrickSide * y) & 0xff) << (kBrickSide * i);
      }
    }
    return any;
  }

  std::array<std::uint8_t, kBrickVoxels> squared_;
};

// Bit x: 255 in byte x.
constexpr std::array<Eight, 256> kSpread = [] {
  std::array<Eight, 256> table{};
  for (std::size_t bits = 0; bits < table.size(); ++bits)
    for (std::size_t x = 0; x < kBrickSide; ++x) table[bits][x] = bits >> x & 1 ? 255 : 0;
  return table;
}();

// The codes of 64 voxels where `mask` is 255: squared ^ flip within the band, else `beyond`.
void takeCodes(const std::uint8_t* __restrict squared, const std::uint8_t* __restrict mask, std::uint8_t band,
               std::uint8_t beyond, std::uint8_t flip, std::uint8_t* __restrict codes) {
  for (std::size_t i = 0; i < kSlice; ++i) {
    const auto code = static_cast<std::uint8_t>(squared[i] <= band ? squared[i] ^ flip : beyond);
    codes[i] = static_cast<std::uint8_t>((code & mask[i]) | (codes[i] & ~mask[i]));
  }
}

// Writes a field's codes for the solid voxels of a brick, or for the empty ones.
void takeField(const Field& field, const BrickBits& brick, bool solid, std::uint8_t band,
               std::span<std::uint8_t, kBrickVoxels> codes) {
  for (std::size_t z = 0; z < kBrickSide; ++z) {
    const std::uint64_t slice = solid ? brick.slices[z] : ~brick.slices[z];
    std::array<std::uint8_t, kSlice> mask;
    for (std::size_t y = 0; y < kBrickSide; ++y) {
      const Eight& row = kSpread[slice >> (kBrickSide * y) & 0xff];
      std::copy(row.begin(), row.end(), mask.begin() + static_cast<std::ptrdiff_t>(kBrickSide * y));
    }
    takeCodes(field.slice(z), mask.data(), band, solid ? kFarInside : kFarOutside, solid ? 255 : 0,
              codes.data() + z * kSlice);
  }
}

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
  std::fill(codes.begin(), codes.end(), std::uint8_t{0});  // before some are taken
  const auto all = [&](std::uint64_t slice) {
    return std::all_of(std::begin(middle.slices), std::end(middle.slices),
                       [&](std::uint64_t s) { return s == slice; });
  };
  if (!all(~std::uint64_t{0}))
    takeField(Field(around, true, reachOf(band.outside)), middle, false, band.outside, codes);
  if (!all(0)) takeField(Field(around, false, reachOf(band.inside)), middle, true, band.inside, codes);
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
// Distances of a level, from a bit a voxel of its bricks. Only bricks that have both kinds of voxels within
// reach of the band are computed; the others are wholly beyond it.
#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "check.h"
#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/distance.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

enum class Kind : std::uint8_t { kEmpty, kSolid, kMixed };

constexpr BrickBits kNothing{}, kFull = [] {
  BrickBits bits;
  for (std::uint64_t& slice : bits.slices) slice = ~std::uint64_t{0};
  return bits;
}();

// The kind of each brick of the grid, and of those around the grid, which are empty.
class Bricks {
 public:
  Bricks(const glm::ivec3& size)
      : grid_(brickGrid(size)), kinds_(denseCount(grid_)), bits_of_(kinds_.size()) {}

  const glm::ivec3& grid() const { return grid_; }
  // Each brick at most once. Thread-safe for different bricks, once room is made for all slots.
  void makeRoom(std::size_t slots) { bits_.resize(slots); }
  void set(std::size_t cell, std::size_t slot, const BrickBits& bits) {
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (const std::uint64_t slice : bits.slices) {
      any |= slice;
      all &= slice;
    }
    kinds_[cell] = any == 0 ? Kind::kEmpty : all == ~std::uint64_t{0} ? Kind::kSolid : Kind::kMixed;
    bits_of_[cell] = static_cast<std::uint32_t>(slot);
    bits_[slot] = bits;
  }
  void setInside(std::size_t cell) { kinds_[cell] = Kind::kSolid; }

  Kind kind(const glm::ivec3& brick) const {
    return isWithin(brick) ? kinds_[denseIndex(grid_, brick)] : Kind::kEmpty;
  }
  const BrickBits& bits(const glm::ivec3& brick) const {
    const Kind its = kind(brick);
    return its == Kind::kEmpty   ? kNothing
           : its == Kind::kSolid ? kFull
                                 : bits_[bits_of_[denseIndex(grid_, brick)]];
  }
  // True if bricks up to `reach` away hold voxels of the other kind. The brick itself holds one kind.
  bool isBeside(const glm::ivec3& brick, int reach) const {
    const Kind own = kind(brick);
    glm::ivec3 d;
    for (d.z = -reach; d.z <= reach; ++d.z)
      for (d.y = -reach; d.y <= reach; ++d.y)
        for (d.x = -reach; d.x <= reach; ++d.x)
          if (kind(brick + d) != own) return true;
    return false;
  }

 private:
  bool isWithin(const glm::ivec3& brick) const {
    return brick.x >= 0 && brick.y >= 0 && brick.z >= 0 && brick.x < grid_.x && brick.y < grid_.y &&
           brick.z < grid_.z;
  }

  glm::ivec3 grid_;
  std::vector<Kind> kinds_;
  std::vector<std::uint32_t> bits_of_;  // by cell
  std::vector<BrickBits> bits_;
};

// The bits of 512 values, of which those from `least` on are solid.
BrickBits bitsOf(const std::uint8_t* values, std::uint8_t least) {
  BrickBits bits;
  for (std::size_t i = 0; i < kBrickVoxels; ++i)
    bits.slices[i / 64] |= std::uint64_t{values[i] >= least} << (i % 64);
  return bits;
}

Bricks bricksOf(const RawLevel& level, const glm::ivec3& size, int threads) {
  Bricks bricks(size);
  if (level.cells.size() != denseCount(bricks.grid()))
    throw std::invalid_argument("a level does not have one cell for each brick of its grid");
  const std::size_t slots = level.codes.size() / kBrickVoxels;
  bricks.makeRoom(slots);
  parallelFor(
      static_cast<std::int64_t>(level.cells.size()), 256, threads, [&](std::int64_t begin, std::int64_t end) {
        for (auto cell = static_cast<std::size_t>(begin); cell < static_cast<std::size_t>(end); ++cell) {
          if (!(level.cells[cell] & kCellSolid)) continue;
          if (level.cells[cell] == kCellInside) {
            bricks.setInside(cell);
            continue;
          }
          const std::size_t slot = level.cells[cell] & kCellSlotMask;
          if (slot >= slots) throw std::invalid_argument("a cell's slot is beyond the level's codes");
          bricks.set(cell, slot, bitsOf(&level.codes[slot * kBrickVoxels], kSurfaceCode));
        }
      });
  return bricks;
}

Bricks bricksOf(const Occupancy& occupancy, int threads) {
  checkedVolume(occupancy.solid.size(), occupancy.size);
  Bricks bricks(occupancy.size);
  const glm::ivec3 grid = bricks.grid();
  bricks.makeRoom(denseCount(grid));
  parallelFor(
      static_cast<std::int64_t>(denseCount(grid)), 16, threads, [&](std::int64_t begin, std::int64_t end) {
        for (auto cell = static_cast<std::size_t>(begin); cell < static_cast<std::size_t>(end); ++cell) {
          const glm::ivec3 low = voxelAt(grid, cell) * kBrickSide;
          std::array<std::uint8_t, kBrickVoxels> solid{};
          for (int i = 0; i < kBrickVoxels; ++i) {
            const glm::ivec3 v = low + glm::ivec3(i & 7, i >> 3 & 7, i >> 6);
            if (v.x < occupancy.size.x && v.y < occupancy.size.y && v.z < occupancy.size.z)
              solid[static_cast<std::size_t>(i)] = occupancy.solid[occupancy.index(v)];
          }
          bricks.set(cell, cell, bitsOf(solid.data(), 1));
        }
      });
  return bricks;
}

// The number of bricks that a squared distance reaches.
int bricksWithin(int squared) { return squared < (kBrickSide + 1) * (kBrickSide + 1) ? 1 : 2; }

// The codes of a brick; false if all are beyond the band.
bool computeCodes(const Bricks& bricks, const glm::ivec3& brick, DistanceBand band, int reach,
                  std::span<std::uint8_t, kBrickVoxels> codes) {
  std::array<const BrickBits*, 125> around{};
  glm::ivec3 d;
  for (d.z = -reach; d.z <= reach; ++d.z) {
    for (d.y = -reach; d.y <= reach; ++d.y) {
      for (d.x = -reach; d.x <= reach; ++d.x)
        around[static_cast<std::size_t>(d.x + 2 + 5 * (d.y + 2 + 5 * (d.z + 2)))] = &bricks.bits(brick + d);
    }
  }
  computeDistanceCodes(around, band, codes);
  return std::any_of(codes.begin(), codes.end(), [&](std::uint8_t code) { return code != codes[0]; }) ||
         squaredOf(codes[0]) > 0;
}

RawDistances build(const Bricks& bricks, DistanceBand band, int threads) {
  if (band.outside < kNarrowestBand.outside || band.outside > kWidestBand.outside ||
      band.inside < kNarrowestBand.inside || band.inside > kWidestBand.inside)
    throw std::invalid_argument("a band must reach 16 to 225 outside and 4 to 28 inside");
  const glm::ivec3& grid = bricks.grid();
  RawDistances out;
  out.band = band;
  out.cells.resize(denseCount(grid));
  std::vector<std::pair<std::uint64_t, glm::ivec3>> near;  // by Morton code
  glm::ivec3 at;
  for (at.z = 0; at.z < grid.z; ++at.z) {
    for (at.y = 0; at.y < grid.y; ++at.y) {
      for (at.x = 0; at.x < grid.x; ++at.x) {
        const Kind kind = bricks.kind(at);
        out.cells[denseIndex(grid, at)] = kind == Kind::kSolid ? kFarInside : kFarOutside;
        const int reach = bricksWithin(kind == Kind::kSolid ? band.inside : band.outside);
        if (kind == Kind::kMixed || bricks.isBeside(at, reach)) near.emplace_back(mortonCode(at), at);
      }
    }
  }
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  out.codes.resize(near.size() * kBrickVoxels);
  std::vector<std::uint8_t> stored(near.size());
  const int reach = bricksWithin(std::max(band.outside, band.inside));
  parallelFor(static_cast<std::int64_t>(near.size()), 16, threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      stored[i] =
          computeCodes(bricks, near[i].second, band, reach,
                       std::span<std::uint8_t, kBrickVoxels>(&out.codes[i * kBrickVoxels], kBrickVoxels));
  });
  std::uint32_t slots = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (!stored[i]) continue;
    if (slots > kCellSlotMask)
      throw std::invalid_argument("a level of distances would hold more than 16777216 bricks");
    out.cells[denseIndex(grid, near[i].second)] = kCellSolid | slots;
    std::copy_n(out.codes.begin() + static_cast<std::ptrdiff_t>(i * kBrickVoxels), kBrickVoxels,
                out.codes.begin() + static_cast<std::ptrdiff_t>(std::size_t{slots} * kBrickVoxels));
    ++slots;
  }
  out.codes.resize(std::size_t{slots} * kBrickVoxels);
  out.codes.shrink_to_fit();
  if (slots == 0) throw std::invalid_argument("distances need at least one solid voxel");
  return out;
}

}  // namespace

RawDistances buildDistances(const RawLevel& level, const glm::ivec3& size, DistanceBand band, int threads) {
  checkedVolume(size);
  return build(bricksOf(level, size, threads), band, threads);
}

RawDistances buildDistances(const Occupancy& occupancy, DistanceBand band, int threads) {
  return build(bricksOf(occupancy, threads), band, threads);
}

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
// Distances of a level, from a bit a voxel. Only bricks that have both kinds of voxels within reach of the
// band are computed; the others are wholly beyond it.
#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "check.h"
#include "empty_boxes.h"
#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/distance.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

enum class Kind : std::uint8_t { kEmpty, kSolid, kMixed };

// What is in each brick of the grid, and in those around the grid, which are empty.
class Bricks {
 public:
  Bricks(const Occupancy& occupancy, int threads)
      : grid_(brickGrid(occupancy.size)), bits_(occupancy, threads), kinds_(denseCount(grid_)) {
    parallelFor(grid_.z, grainOf(std::int64_t{grid_.x} * grid_.y * kBrickVoxels), threads,
                [&](std::int64_t begin, std::int64_t end) {
                  glm::ivec3 at{0};
                  for (at.z = static_cast<int>(begin); at.z < end; ++at.z)
                    for (at.y = 0; at.y < grid_.y; ++at.y)
                      for (at.x = 0; at.x < grid_.x; ++at.x) kinds_[denseIndex(grid_, at)] = kindOf(at);
                });
  }

  const glm::ivec3& grid() const { return grid_; }
  Kind kind(const glm::ivec3& brick) const {
    return isWithin(brick) ? kinds_[denseIndex(grid_, brick)] : Kind::kEmpty;
  }
  BrickBits bits(const glm::ivec3& brick) const {
    BrickBits bits;
    if (!isWithin(brick)) return bits;
    for (int z = 0; z < kBrickSide; ++z)
      for (int y = 0; y < kBrickSide; ++y)
        bits.slices[z] |=
            std::uint64_t{bits_.row(brick.x, brick.y * kBrickSide + y, brick.z * kBrickSide + z)}
            << (kBrickSide * y);
    return bits;
  }
  // Whether bricks up to `reach` away hold voxels of the other kind than the brick, which holds one kind.
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
  Kind kindOf(const glm::ivec3& brick) const {
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (const std::uint64_t slice : bits(brick).slices) {
      any |= slice;
      all &= slice;
    }
    return any == 0 ? Kind::kEmpty : all == ~std::uint64_t{0} ? Kind::kSolid : Kind::kMixed;
  }

  glm::ivec3 grid_;
  SolidBits bits_;
  std::vector<Kind> kinds_;
};

// How many bricks away a squared distance reaches.
int bricksOf(int squared) { return squared < (kBrickSide + 1) * (kBrickSide + 1) ? 1 : 2; }

// The codes of a brick; false if all are beyond the band.
bool computeCodes(const Bricks& bricks, const glm::ivec3& brick, DistanceBand band, int reach,
                  std::span<std::uint8_t, kBrickVoxels> codes) {
  std::array<BrickBits, 125> bits;
  std::array<const BrickBits*, 125> around{};
  glm::ivec3 d;
  for (d.z = -reach; d.z <= reach; ++d.z) {
    for (d.y = -reach; d.y <= reach; ++d.y) {
      for (d.x = -reach; d.x <= reach; ++d.x) {
        const auto at = static_cast<std::size_t>(d.x + 2 + 5 * (d.y + 2 + 5 * (d.z + 2)));
        bits[at] = bricks.bits(brick + d);
        around[at] = &bits[at];
      }
    }
  }
  computeDistanceCodes(around, band, codes);
  return std::any_of(codes.begin(), codes.end(), [&](std::uint8_t code) { return code != codes[0]; }) ||
         squaredOf(codes[0]) > 0;
}

}  // namespace

RawDistances buildDistances(const Occupancy& occupancy, DistanceBand band, int threads) {
  checkedVolume(occupancy.solid.size(), occupancy.size);
  if (std::all_of(occupancy.solid.begin(), occupancy.solid.end(), [](std::uint8_t s) { return s == 0; }))
    throw std::invalid_argument("distances need at least one solid voxel");
  if (band.outside < kNarrowestBand.outside || band.outside > kWidestBand.outside ||
      band.inside < kNarrowestBand.inside || band.inside > kWidestBand.inside)
    throw std::invalid_argument("a band must reach 16 to 225 outside and 4 to 28 inside");
  const Bricks bricks(occupancy, threads);
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
        const int reach = bricksOf(kind == Kind::kSolid ? band.inside : band.outside);
        if (kind == Kind::kMixed || bricks.isBeside(at, reach)) near.emplace_back(mortonCode(at), at);
      }
    }
  }
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  out.codes.resize(near.size() * kBrickVoxels);
  std::vector<std::uint8_t> stored(near.size());
  const int reach = bricksOf(std::max(band.outside, band.inside));
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
  return out;
}

}  // namespace kelp::fields

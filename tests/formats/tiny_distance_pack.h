// SPDX-License-Identifier: MIT
// A small pack with distances, found by trying every pair of voxels. Its bytes are checked in as
// golden/distance.kelp.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "kelp/formats/distance.h"
#include "kelp/formats/raw_pack.h"
#include "tiny_pack.h"

namespace kelp::test {

// The code of a voxel that may lie outside of the level. solid(voxel) answers for voxels of the level.
template <class Solid>
std::uint8_t bruteDistanceCode(const glm::ivec3& voxel, const glm::ivec3& size, DistanceBand band,
                               const Solid& solid) {
  const auto isSolid = [&](const glm::ivec3& v) {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size.x && v.y < size.y && v.z < size.z && solid(v);
  };
  const bool own = isSolid(voxel);
  const int limit = own ? band.inside : band.outside;
  int nearest = limit + 1;
  glm::ivec3 d;
  for (d.z = -15; d.z <= 15; ++d.z)
    for (d.y = -15; d.y <= 15; ++d.y)
      for (d.x = -15; d.x <= 15; ++d.x)
        if (const int squared = d.x * d.x + d.y * d.y + d.z * d.z;
            squared < nearest && isSolid(voxel + d) != own)
          nearest = squared;
  if (nearest > limit) return own ? kFarInside : kFarOutside;
  return static_cast<std::uint8_t>(own ? 255 - nearest : nearest);
}

// A level of distances of a shape.
template <class Solid>
RawDistances bruteDistances(const glm::ivec3& size, DistanceBand band, const Solid& solid) {
  const glm::ivec3 grid = brickGrid(size);
  RawDistances out;
  out.band = band;
  out.cells.resize(static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) *
                   static_cast<std::size_t>(grid.z));
  std::vector<std::pair<std::uint64_t, glm::ivec3>> bricks;
  glm::ivec3 b;
  for (b.z = 0; b.z < grid.z; ++b.z)
    for (b.y = 0; b.y < grid.y; ++b.y)
      for (b.x = 0; b.x < grid.x; ++b.x) bricks.emplace_back(mortonCode(b), b);
  std::sort(bricks.begin(), bricks.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  std::uint32_t slot = 0;
  for (const auto& [code, brick] : bricks) {
    std::vector<std::uint8_t> codes;
    for (int i = 0; i < kBrickVoxels; ++i)
      codes.push_back(
          bruteDistanceCode(brick * 8 + glm::ivec3(i & 7, i >> 3 & 7, i >> 6), size, band, solid));
    const bool far = (codes[0] == kFarOutside || codes[0] == kFarInside) &&
                     std::all_of(codes.begin(), codes.end(), [&](std::uint8_t c) { return c == codes[0]; });
    const auto at = static_cast<std::size_t>(brick.x + grid.x * (brick.y + grid.y * brick.z));
    out.cells[at] = far ? codes[0] : kCellSolid | slot++;
    if (!far) out.codes.insert(out.codes.end(), codes.begin(), codes.end());
  }
  return out;
}

// All levels of distances of a part of `size` with so many levels of voxels; shape(voxel of level 0).
template <class Solid>
std::vector<RawDistances> bruteDistancesOf(const glm::ivec3& size, int levels, const Solid& solid) {
  std::vector<RawDistances> out;
  for (int level = 0; level < distanceLevels(size, levels); ++level) {
    const auto covered = [&](const glm::ivec3& v) {
      const glm::ivec3 low = v << level, high = glm::min((v + 1) << level, size);
      glm::ivec3 p;
      for (p.z = low.z; p.z < high.z; ++p.z)
        for (p.y = low.y; p.y < high.y; ++p.y)
          for (p.x = low.x; p.x < high.x; ++p.x)
            if (solid(p)) return true;
      return false;
    };
    out.push_back(bruteDistances(levelSize(size, level), distanceBand(size, levels, level), covered));
  }
  return out;
}

inline RawPack makeTinyDistancePack() {
  RawPack pack = makeTinyPack();
  pack.parts[0].distances = bruteDistancesOf(pack.parts[0].size, 2, [](const glm::ivec3& v) {
    return v.y < 3 || (v.x + v.z > 5 && v.x < 7 && v.y < 14);
  });
  pack.parts[1].distances =
      bruteDistancesOf(pack.parts[1].size, 1, [](const glm::ivec3& v) { return v.x == 1; });
  return pack;
}

}  // namespace kelp::test

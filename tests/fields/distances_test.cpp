// SPDX-License-Identifier: MIT
// buildDistances against the transform of the whole volume, which brute force checks elsewhere.
#include <gtest/gtest.h>

#include "kelp/formats/distance.h"
#include "volumes.h"

namespace kelp::fields {
namespace {

// The volume with a margin that nothing in the band can see through, as the format pads it.
Occupancy padded(const Occupancy& occupancy, int margin) {
  return test::volumeWhere(occupancy.size + 2 * margin, [&](const glm::ivec3& v) {
    const glm::ivec3 p = v - margin;
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < occupancy.size.x && p.y < occupancy.size.y &&
           p.z < occupancy.size.z && occupancy.solid[occupancy.index(p)] != 0;
  });
}

void expectExact(const Occupancy& occupancy, DistanceBand band, int threads) {
  constexpr int kMargin = 8;  // what bricks overhang, and one voxel
  const Occupancy all = padded(occupancy, kMargin);
  std::vector<std::uint8_t> empty(all.solid.size());
  for (std::size_t i = 0; i < empty.size(); ++i) empty[i] = all.solid[i] == 0;
  std::vector<std::uint32_t> to_solid(empty.size()), to_empty(empty.size());
  squaredDistance(all.solid, all.size, to_solid, 1);
  squaredDistance(empty, all.size, to_empty, 1);

  const RawDistances level = buildDistances(occupancy, band, threads);
  const glm::ivec3 grid = brickGrid(occupancy.size);
  ASSERT_EQ(level.cells.size(), static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) *
                                    static_cast<std::size_t>(grid.z));
  std::size_t stored = 0;
  for (std::size_t cell = 0; cell < level.cells.size(); ++cell) {
    const glm::ivec3 brick = test::voxelAt(cell, grid);
    const bool kept = level.cells[cell] & kCellSolid;
    const std::size_t slot = level.cells[cell] & kCellSlotMask;
    bool one = true;
    for (int i = 0; i < kBrickVoxels; ++i) {
      const glm::ivec3 v = brick * kBrickSide + glm::ivec3(i & 7, i >> 3 & 7, i >> 6);
      const std::size_t at = all.index(v + kMargin);
      const std::uint32_t squared = all.solid[at] ? to_empty[at] : to_solid[at];
      const std::uint32_t expected = all.solid[at] ? (squared <= band.inside ? 255 - squared : kFarInside)
                                                   : (squared <= band.outside ? squared : kFarOutside);
      const std::uint32_t got =
          kept ? level.codes[slot * kBrickVoxels + static_cast<std::size_t>(i)] : level.cells[cell];
      ASSERT_EQ(got, expected) << v.x << " " << v.y << " " << v.z;
      one = one && got == (all.solid[at] ? kFarInside : kFarOutside);
    }
    ASSERT_EQ(kept, !one);
    stored += kept;
  }
  EXPECT_EQ(level.codes.size(), stored * kBrickVoxels);

  const RawDistances of_level = buildDistances(buildLevel(occupancy, {}, 1), occupancy.size, band, threads);
  EXPECT_EQ(of_level.cells, level.cells);
  EXPECT_EQ(of_level.codes, level.codes);
}

TEST(Distances, AreThoseOfTheWholeVolume) {
  for (const test::NamedVolume& volume : test::hardVolumes()) {
    SCOPED_TRACE(volume.name);
    const auto& solid = volume.occupancy.solid;
    if (std::all_of(solid.begin(), solid.end(), [](std::uint8_t s) { return s == 0; })) continue;
    for (const DistanceBand band : {DistanceBand(), kNarrowestBand, kWidestBand})
      expectExact(volume.occupancy, band, 2);
  }
}

// Large enough for bricks that are wholly beyond the band, outside and inside.
TEST(Distances, FarBricksAreNotStored) {
  const Occupancy ball = test::volumeWhere({130, 90, 100}, [](const glm::ivec3& v) {
    const glm::ivec3 d = v - glm::ivec3(70, 50, 47);
    return d.x * d.x + d.y * d.y + d.z * d.z < 38 * 38 && d.x * d.x + d.z * d.z > 9;
  });
  expectExact(ball, {}, 2);
  const RawDistances level = buildDistances(ball, {}, 1);
  EXPECT_GT(std::count(level.cells.begin(), level.cells.end(), std::uint32_t{kFarInside}), 5);
  EXPECT_GT(std::count(level.cells.begin(), level.cells.end(), std::uint32_t{kFarOutside}), 100);
  EXPECT_EQ(buildDistances(ball, {}, 3).codes, level.codes);
}

TEST(Distances, NeedSomethingSolidAndABandOfTheFormat) {
  EXPECT_THROW(buildDistances(test::emptyVolume({4, 4, 4}), {}, 1), std::invalid_argument);
  const Occupancy full = test::volumeWhere({4, 4, 4}, [](const glm::ivec3&) { return true; });
  EXPECT_THROW(buildDistances(full, {15, 4}, 1), std::invalid_argument);
  EXPECT_THROW(buildDistances(full, {16, 29}, 1), std::invalid_argument);
  RawLevel level = buildLevel(full, {}, 1);
  EXPECT_THROW(buildDistances(level, {9, 4, 4}, {}, 1), std::invalid_argument);
  level.cells[0] |= 1;
  EXPECT_THROW(buildDistances(level, {4, 4, 4}, {}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "reference_fields.h"
#include "volumes.h"

namespace kelp::test {
namespace {

bool anySolid(const fields::Occupancy& occupancy) {
  return std::find(occupancy.solid.begin(), occupancy.solid.end(), 1) != occupancy.solid.end();
}

glm::ivec3 voxelAt(std::uint64_t index, const glm::ivec3& size) {
  const auto x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
}

// The surface with attributes that can be told apart.
std::vector<fields::SurfaceVoxel> numberedSurface(const fields::Occupancy& occupancy) {
  std::vector<fields::SurfaceVoxel> surface;
  for (const std::uint64_t index : fields::surfaceVoxels(occupancy, 1))
    surface.push_back({index, static_cast<std::uint32_t>(index * 2654435761u + 17)});
  return surface;
}

std::uint64_t mortonByBits(const glm::ivec3& brick) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 16; ++bit) {
    for (int axis = 0; axis < 3; ++axis) code |= std::uint64_t((brick[axis] >> bit) & 1) << (3 * bit + axis);
  }
  return code;
}

// Everything that brick.h says about a level, from the occupancy and the surface, by brute force.
void checkLevel(const RawLevel& level, const fields::Occupancy& occupancy, const std::vector<fields::SurfaceVoxel>& surface) {
  const glm::ivec3 size = occupancy.size;
  const glm::ivec3 grid((size.x + 7) / 8, (size.y + 7) / 8, (size.z + 7) / 8);
  std::vector<glm::ivec3> solid;
  for (std::size_t i = 0; i < occupancy.solid.size(); ++i) {
    if (occupancy.solid[i]) solid.push_back(voxelAt(i, size));
  }
  const auto leastGap = [&](const glm::ivec3& low, int extent) {
    std::int64_t least = fields::kNoFeature;
    for (const glm::ivec3& voxel : solid) least = std::min(least, squaredGap(low, extent, voxel));
    return least;
  };
  ASSERT_EQ(level.cells.size(),
            static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(grid.z));
  ASSERT_EQ(level.codes.size() % kBrickVoxels, 0u);
  ASSERT_EQ(level.attributes.size(), surface.size());

  std::vector<std::pair<std::uint64_t, std::uint32_t>> slots;  // Morton code, slot
  std::size_t cell_index = 0;
  glm::ivec3 brick;
  for (brick.z = 0; brick.z < grid.z; ++brick.z) {
    for (brick.y = 0; brick.y < grid.y; ++brick.y) {
      for (brick.x = 0; brick.x < grid.x; ++brick.x, ++cell_index) {
        const std::uint32_t cell = level.cells[cell_index];
        const glm::ivec3 low = brick * 8;
        const bool holds = std::any_of(solid.begin(), solid.end(), [&](const glm::ivec3& v) { return v / 8 == brick; });
        ASSERT_EQ((cell >> 31) != 0, holds);
        if (!holds) {
          ASSERT_EQ(cell, static_cast<std::uint32_t>(std::floor(256.0L * std::sqrt(static_cast<long double>(leastGap(low, 8))))));
          continue;
        }
        ASSERT_EQ(cell & 0x7f000000u, 0u);
        slots.emplace_back(mortonByBits(brick), cell & 0xffffffu);
        ASSERT_LT((cell & 0xffffffu) * 512u, level.codes.size());
        for (int i = 0; i < 512; ++i) {
          const glm::ivec3 v = low + glm::ivec3(i % 8, i / 8 % 8, i / 64);
          const std::uint8_t code = level.codes[(cell & 0xffffffu) * 512u + static_cast<std::size_t>(i)];
          const bool inside = v.x < size.x && v.y < size.y && v.z < size.z;
          if (inside && occupancy.solid[occupancy.index(v)]) {
            ASSERT_TRUE((code >= 64 && code < 128) || code == 128);
          } else {
            ASSERT_EQ(code, static_cast<int>(std::floor(4.0L * std::sqrt(static_cast<long double>(leastGap(v, 1))))));
            ASSERT_LE(code, 41);
          }
        }
      }
    }
  }
  ASSERT_EQ(slots.size() * 512, level.codes.size());
  std::sort(slots.begin(), slots.end());
  for (std::size_t i = 0; i < slots.size(); ++i) ASSERT_EQ(slots[i].second, i);

  // Walk the codes in order: ranks count up in each slice of 64, and the attributes follow.
  std::vector<std::uint64_t> morton_to_cell(slots.size());
  for (std::size_t i = 0; i < level.cells.size(); ++i) {
    if (level.cells[i] >> 31) morton_to_cell[level.cells[i] & 0xffffffu] = i;
  }
  std::size_t next = 0;
  int rank = 0;
  for (std::size_t i = 0; i < level.codes.size(); ++i) {
    if (i % 64 == 0) rank = 0;
    const glm::ivec3 base = voxelAt(morton_to_cell[i / 512], grid) * 8;
    const int at = static_cast<int>(i % 512);
    const glm::ivec3 v = base + glm::ivec3(at % 8, at / 8 % 8, at / 64);
    const bool inside = v.x < size.x && v.y < size.y && v.z < size.z;
    const std::uint64_t index = inside ? occupancy.index(v) : ~std::uint64_t{0};
    const auto listed =
        std::lower_bound(surface.begin(), surface.end(), index, [](const auto& a, std::uint64_t b) { return a.index < b; });
    if (listed != surface.end() && listed->index == index) {
      ASSERT_EQ(level.codes[i], 64 + rank++);
      ASSERT_EQ(level.attributes[next++], listed->attribute);
    } else {
      ASSERT_TRUE(level.codes[i] < 64 || level.codes[i] == 128);
    }
  }
  ASSERT_EQ(next, surface.size());
}

TEST(BuildLevel, HoldsWhatBrickHSays) {
  int checked = 0;
  const auto volumes = hardVolumes();
  // All pairs of all padded voxels are many: every seventh volume meets all sizes and all shapes.
  for (std::size_t i = 0; i < volumes.size(); i += 7) {
    const fields::Occupancy& occupancy = volumes[i].occupancy;
    if (!anySolid(occupancy)) continue;
    const auto surface = numberedSurface(occupancy);
    checkLevel(fields::buildLevel(occupancy, surface, 2), occupancy, surface);
    if (HasFatalFailure()) FAIL() << volumes[i].name;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(BuildLevel, IsUndoneByOccupancyOf) {
  for (const NamedVolume& volume : hardVolumes()) {
    if (!anySolid(volume.occupancy)) continue;
    const RawLevel level = fields::buildLevel(volume.occupancy, numberedSurface(volume.occupancy), 2);
    ASSERT_EQ(fields::occupancyOf(level, volume.occupancy.size).solid, volume.occupancy.solid) << volume.name;
  }
}

TEST(BuildLevel, HoldsWhatBrickHSaysOverManyBricks) {
  for (const double density : {0.0003, 0.003, 0.03}) {
    const auto volume = randomVolume({37, 41, 29}, density, 21);
    const auto surface = numberedSurface(volume);
    checkLevel(fields::buildLevel(volume, surface, 3), volume, surface);
    if (HasFatalFailure()) FAIL() << "density " << density;
  }
}

// Only some solid voxels have attributes at the coarser levels.
TEST(BuildLevel, TakesAnySubsetOfTheSolidVoxelsAsSurface) {
  const auto volume = randomVolume({20, 17, 23}, 0.6, 4);
  std::vector<fields::SurfaceVoxel> surface;
  for (std::size_t i = 0; i < volume.solid.size(); ++i) {
    if (volume.solid[i] && i % 3 == 0) surface.push_back({i, static_cast<std::uint32_t>(7 * i)});
  }
  checkLevel(fields::buildLevel(volume, surface, 1), volume, surface);
  checkLevel(fields::buildLevel(volume, {}, 1), volume, {});
}

TEST(BuildLevel, IsTheSameForAnyNumberOfThreads) {
  const auto volume = randomVolume({90, 70, 80}, 0.001, 8);
  const auto surface = numberedSurface(volume);
  const RawLevel one = fields::buildLevel(volume, surface, 1);
  for (const int threads : {0, 2, 3, 4}) {
    const RawLevel level = fields::buildLevel(volume, surface, threads);
    EXPECT_EQ(level.cells, one.cells);
    EXPECT_EQ(level.codes, one.codes);
    EXPECT_EQ(level.attributes, one.attributes);
  }
}

TEST(BuildLevel, RefusesWhatDoesNotFit) {
  auto volume = emptyVolume({10, 10, 10});
  EXPECT_THROW(fields::buildLevel(volume, {}, 1), std::invalid_argument);
  volume.solid[5] = volume.solid[9] = 1;
  using List = std::vector<fields::SurfaceVoxel>;
  EXPECT_NO_THROW(fields::buildLevel(volume, List{{5, 1}, {9, 2}}, 1));
  EXPECT_THROW(fields::buildLevel(volume, List{{9, 1}, {5, 2}}, 1), std::invalid_argument);
  EXPECT_THROW(fields::buildLevel(volume, List{{5, 1}, {5, 2}}, 1), std::invalid_argument);
  EXPECT_THROW(fields::buildLevel(volume, List{{6, 1}}, 1), std::invalid_argument);
  EXPECT_THROW(fields::buildLevel(volume, List{{1000, 1}}, 1), std::invalid_argument);
  EXPECT_THROW(fields::buildLevel(volume, List{{~std::uint64_t{0}, 1}}, 1), std::invalid_argument);
  volume.solid.pop_back();
  EXPECT_THROW(fields::buildLevel(volume, {}, 1), std::invalid_argument);
}

TEST(OccupancyOf, RefusesWhatIsNotALevel) {
  auto volume = emptyVolume({10, 10, 10});
  volume.solid[volume.index({9, 9, 9})] = 1;
  const RawLevel good = fields::buildLevel(volume, {}, 1);
  EXPECT_THROW(fields::occupancyOf(good, {10, 10, 17}), std::invalid_argument);
  EXPECT_THROW(fields::occupancyOf(good, {10, 10, 9}), std::invalid_argument) << "a solid voxel outside";
  RawLevel slot = good;
  slot.cells.back() += 1;
  EXPECT_THROW(fields::occupancyOf(slot, {10, 10, 10}), std::invalid_argument);
  RawLevel codes = good;
  codes.codes.pop_back();
  EXPECT_THROW(fields::occupancyOf(codes, {10, 10, 10}), std::invalid_argument);
}

TEST(Coarser, IsSolidWhereAnyOfTheEightIs) {
  for (const NamedVolume& volume : hardVolumes()) {
    const fields::Occupancy& fine = volume.occupancy;
    const fields::Occupancy coarse = fields::coarser(fine);
    ASSERT_EQ(coarse.size, glm::ivec3((fine.size.x + 1) / 2, (fine.size.y + 1) / 2, (fine.size.z + 1) / 2)) << volume.name;
    const auto expected = volumeWhere(coarse.size, [&](const glm::ivec3& v) {
      for (int i = 0; i < 8; ++i) {
        const glm::ivec3 child = 2 * v + glm::ivec3(i & 1, (i >> 1) & 1, i >> 2);
        if (child.x < fine.size.x && child.y < fine.size.y && child.z < fine.size.z && fine.solid[fine.index(child)]) return true;
      }
      return false;
    });
    ASSERT_EQ(coarse.solid, expected.solid) << volume.name;
  }
}

TEST(PeakBytes, CoversFiveBytesAVoxelOfWholeBricks) {
  EXPECT_GE(fields::peakBytes({8, 8, 8}), 5u * 512u);
  EXPECT_EQ(fields::peakBytes({9, 1, 17}), fields::peakBytes({16, 8, 24}));
  EXPECT_LT(fields::peakBytes({512, 512, 512}), 6ull * 512 * 512 * 512);
  EXPECT_GT(fields::peakBytes({4096, 4096, 4096}), 5ull << 36);
}

}  // namespace
}  // namespace kelp::test

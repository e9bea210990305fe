// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <random>
#include <span>

#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "peak_allocated.h"
#include "reference_fields.h"
#include "support/all_tests.h"
#include "support/boxed_level.h"
#include "volumes.h"

namespace kelp::test {
namespace {

bool anySolid(const fields::Occupancy& occupancy) {
  return std::find(occupancy.solid.begin(), occupancy.solid.end(), 1) != occupancy.solid.end();
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

// The mean over all directions of the steps per voxel of a ray that meets boxes of these reaches (as k, reach
// 2^k - 1) and stands in their middles: it leaves such a box by the axis that it crosses first. Midpoints
// over the first octant.
double meanSteps(const std::array<int, 3>& k) {
  constexpr int kSteps = 300;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double y = (i + 0.5) / kSteps, around = std::sqrt(1 - y * y);
    for (int j = 0; j < kSteps; ++j) {
      const double angle = (j + 0.5) / kSteps * std::acos(0.0);
      sum += std::max({around * std::cos(angle) / (std::exp2(k[0]) - 0.5), y / (std::exp2(k[1]) - 0.5),
                       around * std::sin(angle) / (std::exp2(k[2]) - 0.5)});
    }
  }
  return sum / (kSteps * kSteps);
}

std::array<int, 3> exponentsOf(int code) { return {code % 4, code / 4 % 4, code / 16}; }

// meanSteps by code, the same number for all orders of three reaches.
const std::array<double, 64>& costs() {
  static const std::array<double, 64> all = [] {
    std::array<double, 64> table;
    std::map<std::array<int, 3>, double> by_sorted;
    for (int code = 0; code < 64; ++code) {
      std::array<int, 3> k = exponentsOf(code);
      std::sort(k.begin(), k.end());
      const auto known = by_sorted.find(k);
      table[static_cast<std::size_t>(code)] =
          known != by_sorted.end() ? known->second : by_sorted[k] = meanSteps(k);
    }
    return table;
  }();
  return all;
}

// The codes whose boxes around `voxel` are empty, one bit each, from all solid voxels that a box could meet.
std::uint64_t emptyCodes(const fields::Occupancy& occupancy, const glm::ivec3& voxel) {
  // [|dx| + 8 |dy| + 64 |dz|]: codes whose boxes reach that far
  static const std::vector<std::uint64_t> meeting = [] {
    std::vector<std::uint64_t> masks(512);
    for (int i = 0; i < 512; ++i) {
      for (int code = 0; code < 64; ++code) {
        const std::array<int, 3> k = exponentsOf(code);
        const bool reaches =
            i % 8 < std::exp2(k[0]) && i / 8 % 8 < std::exp2(k[1]) && i / 64 < std::exp2(k[2]);
        masks[static_cast<std::size_t>(i)] |= std::uint64_t{reaches} << code;
      }
    }
    return masks;
  }();
  std::uint64_t empty = ~std::uint64_t{0};
  glm::ivec3 v;
  for (v.z = std::max(voxel.z - 7, 0); v.z <= std::min(voxel.z + 7, occupancy.size.z - 1); ++v.z) {
    for (v.y = std::max(voxel.y - 7, 0); v.y <= std::min(voxel.y + 7, occupancy.size.y - 1); ++v.y) {
      for (v.x = std::max(voxel.x - 7, 0); v.x <= std::min(voxel.x + 7, occupancy.size.x - 1); ++v.x) {
        const glm::ivec3 d = glm::abs(v - voxel);
        if (occupancy.solid[occupancy.index(v)])
          empty &= ~meeting[static_cast<std::size_t>(d.x + 8 * d.y + 64 * d.z)];
      }
    }
  }
  return empty;
}

// Of the empty boxes the one of the least cost, then of the lowest code.
int cheapestCode(std::uint64_t empty) {
  int best = 0;
  for (int code = 0; code < 64; ++code) {
    if ((empty >> code & 1) &&
        costs()[static_cast<std::size_t>(code)] < costs()[static_cast<std::size_t>(best)])
      best = code;
  }
  return best;
}

// True if any brick in [low, high] is stored.
bool anyStored(const RawLevel& level, const glm::ivec3& grid, const glm::ivec3& low, const glm::ivec3& high) {
  for (int z = std::max(low.z, 0); z <= std::min(high.z, grid.z - 1); ++z) {
    for (int y = std::max(low.y, 0); y <= std::min(high.y, grid.y - 1); ++y) {
      for (int x = std::max(low.x, 0); x <= std::min(high.x, grid.x - 1); ++x) {
        if (level.cells[static_cast<std::size_t>(x + grid.x * (y + grid.y * z))] >> 31) return true;
      }
    }
  }
  return false;
}

// The box of an empty brick, grown as SPEC.md says; its reach on side -x, +x, -y, +y, -z, +z.
std::array<int, 6> grownBox(const RawLevel& level, const glm::ivec3& grid, const glm::ivec3& brick) {
  std::array<int, 6> reach{};
  const auto slabIsFree = [&](int side) {
    glm::ivec3 low = brick - glm::ivec3(reach[0], reach[2], reach[4]),
               high = brick + glm::ivec3(reach[1], reach[3], reach[5]);
    (side % 2 ? high : low)[side / 2] += side % 2 ? 1 : -1;
    (side % 2 ? low : high)[side / 2] = (side % 2 ? high : low)[side / 2];
    return !anyStored(level, grid, low, high);
  };
  for (bool moved = true; moved;) {
    moved = false;
    for (int side = 0; side < 6; ++side) {
      if (reach[static_cast<std::size_t>(side)] == 15 || !slabIsFree(side)) continue;
      ++reach[static_cast<std::size_t>(side)];
      moved = true;
    }
  }
  return reach;
}

// Everything that brick.h says about a level, from the occupancy and the surface, by brute force.
void checkLevel(const RawLevel& level, const fields::Occupancy& occupancy,
                const std::vector<fields::SurfaceVoxel>& surface) {
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
  ASSERT_EQ(level.cells.size(), static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) *
                                    static_cast<std::size_t>(grid.z));
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
        const bool holds =
            std::any_of(solid.begin(), solid.end(), [&](const glm::ivec3& v) { return v / 8 == brick; });
        ASSERT_EQ((cell >> 31) != 0, holds);
        if (!holds) {
          const std::array<int, 6> reach = grownBox(level, grid, brick);
          for (int side = 0; side < 6; ++side)
            ASSERT_EQ(cell >> (4 * side) & 15,
                      static_cast<std::uint32_t>(reach[static_cast<std::size_t>(side)]))
                << side;
          ASSERT_FALSE(anyStored(level, grid, brick - glm::ivec3(reach[0], reach[2], reach[4]),
                                 brick + glm::ivec3(reach[1], reach[3], reach[5])));
          ASSERT_EQ(cell >> 24,
                    std::min<std::uint32_t>(127, static_cast<std::uint32_t>(
                                                     std::sqrt(static_cast<long double>(leastGap(low, 8))))));
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
            const std::uint64_t empty = emptyCodes(occupancy, v);
            ASSERT_LT(code, 64);
            ASSERT_TRUE(empty >> code & 1) << "a solid voxel in the box of code " << int{code};
            ASSERT_EQ(code, cheapestCode(empty));
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
    const auto listed = std::lower_bound(surface.begin(), surface.end(), index,
                                         [](const auto& a, std::uint64_t b) { return a.index < b; });
    if (listed != surface.end() && listed->index == index) {
      ASSERT_EQ(level.codes[i], 64 + rank++);
      ASSERT_EQ(level.attributes[next++], listed->attribute);
    } else {
      ASSERT_TRUE(level.codes[i] < 64 || level.codes[i] == 128);
    }
  }
  ASSERT_EQ(next, surface.size());
}

// The order of empty_boxes.h, by shortest, middle and longest reach, is the order of the cost.
TEST(EmptyBoxes, TheSimpleOrderIsThatOfTheCost) {
  std::map<std::array<int, 3>, double> by_sorted;
  for (int code = 0; code < 64; ++code) {
    std::array<int, 3> k = exponentsOf(code);
    EXPECT_NEAR(costs()[static_cast<std::size_t>(code)], meanSteps(k), 1e-5)
        << "one cost for all orders of three reaches, code " << code;
    std::sort(k.begin(), k.end());
    by_sorted[k] = costs()[static_cast<std::size_t>(code)];
  }
  ASSERT_EQ(by_sorted.size(), 20u);
  for (auto worse = by_sorted.begin(), better = std::next(worse); better != by_sorted.end();
       ++worse, ++better) {
    EXPECT_GT(worse->second, better->second + 1e-3)
        << better->first[0] << better->first[1] << better->first[2];
  }
  EXPECT_NEAR(costs()[0], 1.6624, 1e-4);
  EXPECT_NEAR(costs()[63], 0.1108, 1e-4);
}

TEST(BuildLevel, HoldsWhatBrickHSays) {
  int checked = 0;
  const auto volumes = hardVolumes();
  // All pairs of all padded voxels are many: every seventh volume meets all sizes and all shapes.
  for (std::size_t i = 0; i < volumes.size(); i += 7) {
    const fields::Occupancy& occupancy = volumes[i].occupancy;
    if (!anySolid(occupancy)) continue;
    const auto surface = numberedSurface(occupancy);
    checkLevel(test::boxedLevel(occupancy, surface, 2), occupancy, surface);
    if (HasFatalFailure()) FAIL() << volumes[i].name;
    ++checked;
  }
  EXPECT_GT(checked, static_cast<int>(volumes.size()) / 10);
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
    checkLevel(test::boxedLevel(volume, surface, 3), volume, surface);
    if (HasFatalFailure()) FAIL() << "density " << density;
  }
}

// So wide that boxes of bricks end at 15 on every side and clearances at 127.
TEST(BuildLevel, HoldsWhatBrickHSaysWhereBoxesAreLong) {
  const glm::ivec3 size(270, 263, 281);
  const glm::ivec3 middle = size / 2;
  const auto far =
      volumeWhere(size, [&](const glm::ivec3& v) { return v == glm::ivec3(0) || v == size - 1; });
  const auto amid = volumeWhere(size, [&](const glm::ivec3& v) {
    return v == middle || v == middle + glm::ivec3(0, 90, 0) || v == glm::ivec3(3, 200, 9);
  });
  const fields::Occupancy volumes[] = {far, amid};
  for (const fields::Occupancy& volume : std::span(volumes).first(shareOf(2))) {
    const auto surface = numberedSurface(volume);
    const RawLevel level = test::boxedLevel(volume, surface, 2);
    checkLevel(level, volume, surface);
    if (HasFatalFailure()) return;
    EXPECT_NE(std::find(level.cells.begin(), level.cells.end(), 0x7fffffffu), level.cells.end());
  }
}

// Only some solid voxels have attributes at the coarser levels.
TEST(BuildLevel, TakesAnySubsetOfTheSolidVoxelsAsSurface) {
  const auto volume = randomVolume({20, 17, 23}, 0.6, 4);
  std::vector<fields::SurfaceVoxel> surface;
  for (std::size_t i = 0; i < volume.solid.size(); ++i) {
    if (volume.solid[i] && i % 3 == 0) surface.push_back({i, static_cast<std::uint32_t>(7 * i)});
  }
  checkLevel(test::boxedLevel(volume, surface, 1), volume, surface);
  checkLevel(test::boxedLevel(volume, {}, 1), volume, {});
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
    ASSERT_EQ(coarse.size, glm::ivec3((fine.size.x + 1) / 2, (fine.size.y + 1) / 2, (fine.size.z + 1) / 2))
        << volume.name;
    const auto expected = volumeWhere(coarse.size, [&](const glm::ivec3& v) {
      for (int i = 0; i < 8; ++i) {
        const glm::ivec3 child = 2 * v + glm::ivec3(i & 1, (i >> 1) & 1, i >> 2);
        if (child.x < fine.size.x && child.y < fine.size.y && child.z < fine.size.z &&
            fine.solid[fine.index(child)])
          return true;
      }
      return false;
    });
    ASSERT_EQ(coarse.solid, expected.solid) << volume.name;
  }
}

// Against what is allocated, for volumes that are empty, full and in between.
TEST(PeakBytes, CoversWhatIsAllocatedAndLittleMore) {
#ifdef KELP_THREAD_SANITIZER
  GTEST_SKIP() << "nothing is counted under the thread sanitizer";
#endif
  for (const double density : {1.0, 0.02, 0.00001}) {
    for (const glm::ivec3& size :
         {glm::ivec3(200, 161, 96), glm::ivec3(8, 400, 500), glm::ivec3(1, 700, 300)}) {
      const fields::Occupancy volume = randomVolume(size, density, 5);
      const std::vector<fields::SurfaceVoxel> surface = numberedSurface(volume);
      const std::size_t before = resetPeakAllocated();
      const RawLevel level = fields::buildLevel(volume, surface, 2);
      const std::uint64_t used = peakAllocated() - before - 4 * level.attributes.size();
      const std::uint64_t promised = fields::peakBytes(volume.size, level.codes.size() / kBrickVoxels);
      EXPECT_LE(used, promised) << density << ", " << size.x << " wide";
      EXPECT_LE(promised, used + used / 2 + 200000) << density << ", " << size.x << " wide";
    }
  }
}

}  // namespace
}  // namespace kelp::test

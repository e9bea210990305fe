// SPDX-License-Identifier: MIT
// Levels of fog against formats/SPEC.md, section 6, by brute force over samples.
#include "kelp/formats/fog.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "kelp/fields/fields.h"
#include "kelp/formats/empty_boxes.h"
#include "reference_fields.h"
#include "volumes.h"

namespace kelp::test {
namespace {

using fields::FogSamples;

struct NamedFog {
  std::string name;
  FogSamples fog;
};

std::size_t at(const glm::ivec3& size, const glm::ivec3& v) {
  return static_cast<std::size_t>(v.x) +
         static_cast<std::size_t>(size.x) *
             (static_cast<std::size_t>(v.y) +
              static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z));
}

template <class Visit>
void forEach(const glm::ivec3& size, Visit&& visit) {
  glm::ivec3 v{0};
  for (v.z = 0; v.z < size.z; ++v.z)
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) visit(v);
}

// `filled` of the samples are something, and at least one is.
FogSamples noise(const glm::ivec3& size, double density, double heat, std::uint32_t seed) {
  std::mt19937 random(seed);
  FogSamples fog;
  fog.size = size;
  const auto channel = [&](double filled, std::vector<std::uint8_t>& out) {
    forEach(size, [&](const glm::ivec3&) {
      out.push_back(random() < filled * 4294967296.0 ? static_cast<std::uint8_t>(1 + random() % 255)
                                                     : std::uint8_t{0});
    });
  };
  channel(density, fog.density);
  if (heat > 0) channel(heat, fog.heat);
  auto& something = density > 0 ? fog.density : fog.heat;
  something[random() % something.size()] = 77;
  return fog;
}

// Sides of 1, odd ones, and those on either side of a brick; dense, sparse, a single sample, and heat alone.
std::vector<NamedFog> fogs() {
  std::vector<NamedFog> all;
  std::uint32_t seed = 0;
  for (const glm::ivec3& size :
       {glm::ivec3(1, 1, 1), glm::ivec3(1, 1, 20), glm::ivec3(17, 1, 9), glm::ivec3(8, 9, 10),
        glm::ivec3(2, 33, 17), glm::ivec3(25, 16, 41), glm::ivec3(33, 35, 31)}) {
    for (const auto& [density, heat] : {std::pair(0.6, 0.0), std::pair(0.001, 0.0), std::pair(1e-9, 0.0),
                                        std::pair(0.002, 0.0005), std::pair(0.0, 0.001), std::pair(1.0, 1.0)})
      all.push_back({nameOf(size) + " of " + std::to_string(density) + " and " + std::to_string(heat),
                     noise(size, density, heat, ++seed)});
  }
  return all;
}

// True if a sample is not 0; samples beyond the level are.
bool something(const FogSamples& fog, const glm::ivec3& v) {
  if (v.x >= fog.size.x || v.y >= fog.size.y || v.z >= fog.size.z) return false;
  return fog.density[at(fog.size, v)] != 0 || (!fog.heat.empty() && fog.heat[at(fog.size, v)] != 0);
}

fields::Occupancy bruteCubes(const FogSamples& fog) {
  return volumeWhere({std::max(fog.size.x - 1, 1), std::max(fog.size.y - 1, 1), std::max(fog.size.z - 1, 1)},
                     [&](const glm::ivec3& cube) {
                       bool any = false;
                       for (int c = 0; c < 8; ++c)
                         any = any || something(fog, cube + glm::ivec3(c & 1, c >> 1 & 1, c >> 2));
                       return any;
                     });
}

TEST(Fog, CubesAreNotClearWhereACornerIsNot) {
  for (const NamedFog& named : fogs()) {
    const FogSamples& fog = named.fog;
    const fields::Occupancy brute = bruteCubes(fog);
    for (const int threads : {1, 2}) {
      const fields::Occupancy cubes = fields::fogCubes(fog, threads);
      ASSERT_EQ(cubes.size, brute.size) << named.name;
      ASSERT_EQ(cubes.solid, brute.solid) << named.name;
    }
  }
}

TEST(Fog, BricksHoldTheSamplesAtTheirCubesCorners) {
  for (const NamedFog& named : fogs()) {
    const FogSamples& fog = named.fog;
    SCOPED_TRACE(named.name);
    const fields::Occupancy cubes = bruteCubes(fog);
    const glm::ivec3 grid = (cubes.size + 7) / 8;
    const RawLevel level = fields::buildFogLevel(fog, 1);
    ASSERT_EQ(level.cells.size(), static_cast<std::size_t>(grid.x * grid.y * grid.z));
    ASSERT_TRUE(level.codes.empty() && level.attributes.empty());
    std::size_t stored = 0;
    std::vector<std::uint64_t> order;  // Morton codes by slot
    forEach(grid, [&](const glm::ivec3& brick) {
      bool any = false;
      forEach(glm::min(cubes.size - 8 * brick, glm::ivec3(8)),
              [&](const glm::ivec3& cube) { any = any || cubes.solid[cubes.index(8 * brick + cube)]; });
      const std::uint32_t cell = level.cells[at(grid, brick)];
      ASSERT_EQ((cell & kCellSolid) != 0, any);
      if (!any) return;
      ++stored;
      const std::size_t slot = cell & 0x7fffffffu;
      if (order.size() <= slot) order.resize(slot + 1);
      order[slot] = mortonCode(brick);
      ASSERT_LE((slot + 1) * 729, level.density.size());
      forEach({9, 9, 9}, [&](const glm::ivec3& corner) {
        const glm::ivec3 sample = 8 * brick + corner;
        const bool inside = sample.x < fog.size.x && sample.y < fog.size.y && sample.z < fog.size.z;
        const std::size_t i = slot * 729 + static_cast<std::size_t>(corner.x + 9 * corner.y + 81 * corner.z);
        ASSERT_EQ(level.density[i], inside ? fog.density[at(fog.size, sample)] : 0);
        if (!fog.heat.empty()) {
          ASSERT_EQ(level.heat[i], inside ? fog.heat[at(fog.size, sample)] : 0);
        }
      });
    });
    EXPECT_EQ(order.size(), stored);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_EQ(level.density.size(), 729 * stored);
    EXPECT_EQ(level.heat.size(), fog.heat.empty() ? 0 : 729 * stored);
  }
}

TEST(Fog, EmptyBricksPromiseWhatIsThere) {
  int empty = 0;
  for (const NamedFog& named : fogs()) {
    const FogSamples& fog = named.fog;
    SCOPED_TRACE(named.name);
    const fields::Occupancy cubes = bruteCubes(fog);
    const glm::ivec3 grid = (cubes.size + 7) / 8;
    RawLevel level = fields::buildFogLevel(fog, 1);
    ASSERT_TRUE(growBoxes(level.cells, grid));
    const auto stored = [&](const glm::ivec3& low, const glm::ivec3& high) {
      bool any = false;
      forEach(grid, [&](const glm::ivec3& b) {
        const bool within =
            b.x >= low.x && b.y >= low.y && b.z >= low.z && b.x <= high.x && b.y <= high.y && b.z <= high.z;
        any = any || (within && (level.cells[at(grid, b)] & kCellSolid));
      });
      return any;
    };
    forEach(grid, [&](const glm::ivec3& brick) {
      const std::uint32_t cell = level.cells[at(grid, brick)];
      if (cell & kCellSolid) return;
      ++empty;
      // The greatest distance that is not too far, to whole cubes.
      std::int64_t gap = 127 * 127;
      forEach(cubes.size, [&](const glm::ivec3& cube) {
        if (cubes.solid[cubes.index(cube)]) gap = std::min(gap, squaredGap(8 * brick, 8, cube));
      });
      const auto clearance = std::int64_t{cellClearance(cell)};
      ASSERT_LE(clearance * clearance, gap);
      ASSERT_TRUE(clearance == 127 || (clearance + 1) * (clearance + 1) > gap);
      // The box grown in rounds, side by side.
      glm::ivec3 low = brick, high = brick;
      for (bool grew = true; grew;) {
        grew = false;
        for (int side = 0; side < 6; ++side) {
          const int axis = side / 2;
          glm::ivec3 from = low, to = high;
          (side % 2 ? to : from)[axis] += side % 2 ? 1 : -1;
          const bool full = (side % 2 ? to[axis] - brick[axis] : brick[axis] - from[axis]) > 15;
          if (full || stored(from, to)) continue;
          low = from;
          high = to;
          grew = true;
        }
      }
      for (int side = 0; side < 6; ++side)
        ASSERT_EQ(cellReach(cell, side),
                  side % 2 ? high[side / 2] - brick[side / 2] : brick[side / 2] - low[side / 2]);
    });
  }
  EXPECT_GT(empty, 200);
}

TEST(Fog, SamplesComeBackFromALevel) {
  for (const NamedFog& named : fogs()) {
    const FogSamples& fog = named.fog;
    const FogSamples back = fields::fogSamplesOf(fields::buildFogLevel(fog, 1), fog.size);
    EXPECT_EQ(back.size, fog.size);
    EXPECT_EQ(back.density, fog.density) << named.name;
    EXPECT_EQ(back.heat, fog.heat) << named.name;
  }
}

TEST(Fog, CoarserLevelsAreMeansOfEight) {
  for (const NamedFog& named : fogs()) {
    const FogSamples& fog = named.fog;
    SCOPED_TRACE(named.name);
    constexpr float kExtinction = 0.75f;
    float extinction = kExtinction;
    const FogSamples coarse = fields::coarserFog(fog, extinction, 1);
    ASSERT_EQ(coarse.size, (fog.size + 1) / 2);
    ASSERT_EQ(coarse.heat.empty(), fog.heat.empty());
    // extinction * density of each, then the greatest, then the nearest code of all 256.
    std::vector<double> means;
    forEach(coarse.size, [&](const glm::ivec3& v) {
      double sum = 0, heat = 0, there = 0;
      forEach({2, 2, 2}, [&](const glm::ivec3& child) {
        const glm::ivec3 s = 2 * v + child;
        if (s.x >= fog.size.x || s.y >= fog.size.y || s.z >= fog.size.z) return;
        ++there;
        sum += double{kExtinction} * std::pow(fog.density[at(fog.size, s)] / 255.0, 2);
        if (!fog.heat.empty()) heat += fog.heat[at(fog.size, s)];
      });
      means.push_back(sum / there);
      if (fog.heat.empty()) return;
      const int right = heat == 0 ? 0 : std::max(1, static_cast<int>(std::floor(heat / there + 0.5)));
      ASSERT_EQ(coarse.heat[at(coarse.size, v)], right);
    });
    const double greatest = *std::max_element(means.begin(), means.end());
    EXPECT_NEAR(extinction, greatest > 0 ? greatest : double{kExtinction}, 1e-6 * greatest);
    for (std::size_t i = 0; i < means.size(); ++i) {
      const int code = coarse.density[i];
      ASSERT_EQ(code == 0, means[i] == 0);
      if (code == 0) continue;
      const auto away = [&](int c) { return std::abs(greatest * c * c / 65025.0 - means[i]); };
      for (int other = 1; other < 256; ++other)
        ASSERT_LE(away(code), away(other) * (1 + 1e-12) + 1e-15) << code << " " << other;
    }
    if (greatest > 0) {
      EXPECT_EQ(*std::max_element(coarse.density.begin(), coarse.density.end()), 255);
    }
    // A clear cube is clear at the finer level.
    forEach(fog.size,
            [&](const glm::ivec3& v) { ASSERT_TRUE(!something(fog, v) || something(coarse, v / 2)); });
  }
}

TEST(Fog, ThreadsMakeNoDifference) {
  for (const NamedFog& named : fogs()) {
    const FogSamples& fog = named.fog;
    const RawLevel once = fields::buildFogLevel(fog, 1), twice = fields::buildFogLevel(fog, 2);
    EXPECT_EQ(once.cells, twice.cells) << named.name;
    EXPECT_EQ(once.density, twice.density) << named.name;
    EXPECT_EQ(once.heat, twice.heat) << named.name;
    float a = 0.3f, b = 0.3f;
    const FogSamples alone = fields::coarserFog(fog, a, 1), together = fields::coarserFog(fog, b, 2);
    EXPECT_EQ(a, b) << named.name;
    EXPECT_EQ(alone.density, together.density) << named.name;
    EXPECT_EQ(alone.heat, together.heat) << named.name;
  }
}

TEST(Fog, ArgumentsThatDoNotFitAreRefused) {
  const FogSamples sound = noise({10, 9, 8}, 0.5, 0.5, 1);
  FogSamples wrong = sound;
  wrong.density.pop_back();
  EXPECT_THROW(fields::fogCubes(wrong, 1), std::invalid_argument);
  wrong = sound;
  wrong.heat.pop_back();
  EXPECT_THROW(fields::buildFogLevel(wrong, 1), std::invalid_argument);
  wrong = sound;
  std::fill(wrong.density.begin(), wrong.density.end(), std::uint8_t{0});
  std::fill(wrong.heat.begin(), wrong.heat.end(), std::uint8_t{0});
  EXPECT_THROW(fields::buildFogLevel(wrong, 1), std::invalid_argument);
  RawLevel level = fields::buildFogLevel(sound, 1);
  EXPECT_THROW(fields::fogSamplesOf(level, {100, 9, 8}), std::invalid_argument);
  level.cells[0] = kCellSolid | 1000;
  EXPECT_THROW(fields::fogSamplesOf(level, sound.size), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test

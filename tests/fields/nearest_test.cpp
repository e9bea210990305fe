// SPDX-License-Identifier: MIT
// Nearest voxels, distances and signed distances of voxels that are no cubes, against all pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "every_target.h"
#include "kelp/fields/fields.h"
#include "reference_fields.h"
#include "support/all_tests.h"
#include "volumes.h"

namespace kelp::test {
namespace {

const glm::dvec3 kSpacings[] = {{1, 1, 1}, {0.25, 0.25, 0.25}, {1, 2.5, 0.3}, {1e-3, 7, 1}, {0.1, 0.1, 50}};

long double squaredBetween(std::size_t a, std::size_t b, const glm::ivec3& size, const glm::dvec3& spacing) {
  const glm::ivec3 gap = voxelAt(a, size) - voxelAt(b, size);
  long double sum = 0;
  for (int axis = 0; axis < 3; ++axis)
    sum += (static_cast<long double>(spacing[axis]) * gap[axis]) *
           (static_cast<long double>(spacing[axis]) * gap[axis]);
  return sum;
}

// To the nearest voxel that is `wanted`, over all of them.
long double bruteSquared(const std::vector<std::uint8_t>& set, bool wanted, std::size_t from,
                         const glm::ivec3& size, const glm::dvec3& spacing) {
  long double nearest = std::numeric_limits<long double>::infinity();
  for (std::size_t i = 0; i < set.size(); ++i) {
    if ((set[i] != 0) == wanted) nearest = std::min(nearest, squaredBetween(from, i, size, spacing));
  }
  return nearest;
}

TEST(Nearest, IsAsNearAsAnyByBruteForce) {
  for (const glm::dvec3& spacing : kSpacings) {
    for (const double density : {0.0, 0.001, 0.02, 0.4, 1.0}) {
      const auto volume = randomVolume({17, 13, 11}, density, 3);
      const std::vector<std::uint32_t> nearest = fields::nearestSet(volume.solid, volume.size, spacing, 2);
      const std::vector<float> distance = fields::distance(volume.solid, volume.size, spacing, 2);
      const std::vector<float> both = fields::signedDistance(volume.solid, volume.size, spacing, 2);
      for (std::size_t i = 0; i < nearest.size(); ++i) {
        const long double squared = bruteSquared(volume.solid, true, i, volume.size, spacing);
        if (std::isinf(squared)) {
          ASSERT_EQ(nearest[i], fields::kNoFeature);
          ASSERT_TRUE(std::isinf(distance[i]) && distance[i] > 0);
          ASSERT_EQ(both[i], distance[i]);
          continue;
        }
        ASSERT_TRUE(volume.solid[nearest[i]]);
        ASSERT_LE(squaredBetween(i, nearest[i], volume.size, spacing), squared * (1 + 1e-14L))
            << i << " at density " << density;
        ASSERT_NEAR(distance[i], std::sqrt(squared), 1e-7L * std::sqrt(squared));
        if (!volume.solid[i]) {
          ASSERT_EQ(both[i], distance[i]);
        } else if (const long double inside = bruteSquared(volume.solid, false, i, volume.size, spacing);
                   std::isinf(inside)) {
          ASSERT_TRUE(std::isinf(both[i]) && both[i] < 0);
        } else {
          ASSERT_NEAR(both[i], -std::sqrt(inside), 1e-7L * std::sqrt(inside));
        }
      }
    }
  }
}

// Lines, slices and shapes that break transforms: every hard volume of few enough voxels.
TEST(Nearest, IsAsNearAsAnyOnHardVolumes) {
  const glm::dvec3 spacing(1, 2.5, 0.3);
  int checked = 0;
  for (const NamedVolume& volume : hardVolumes()) {
    const auto& [size, set] = volume.occupancy;
    if (set.size() > 350) continue;
    ++checked;
    const std::vector<std::uint32_t> nearest = fields::nearestSet(set, size, spacing, 2);
    const std::vector<float> both = fields::signedDistance(set, size, spacing, 2);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      const long double outside = bruteSquared(set, true, i, size, spacing),
                        inside = bruteSquared(set, false, i, size, spacing);
      if (std::isinf(outside)) {
        ASSERT_EQ(nearest[i], fields::kNoFeature) << volume.name;
      } else {
        ASSERT_TRUE(set[nearest[i]]) << volume.name;
        ASSERT_LE(squaredBetween(i, nearest[i], size, spacing), outside * (1 + 1e-14L)) << volume.name;
      }
      const long double expected = set[i] ? -std::sqrt(inside) : std::sqrt(outside);
      if (std::isinf(expected))
        ASSERT_EQ(both[i], static_cast<float>(expected)) << volume.name;
      else
        ASSERT_NEAR(both[i], expected, 1e-7L * std::abs(expected)) << volume.name;
    }
  }
  EXPECT_GT(checked, test::kSanitized ? 100 : 300);
}

// Cubes go by way of the vectors.
TEST(Distance, OfCubesIsTheRootOnEveryTarget) {
  for (const NamedVolume& volume : hardVolumes()) {
    const glm::ivec3& size = volume.occupancy.size;
    const std::vector<std::uint8_t>& set = volume.occupancy.solid;
    std::vector<std::uint8_t> rest(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) rest[i] = !set[i];
    const auto outside = bruteSquaredDistance(set, size), inside = bruteSquaredDistance(rest, size);
    const auto root = [](std::uint32_t squared) {
      return squared == fields::kNoFeature ? INFINITY : 0.5 * std::sqrt(static_cast<double>(squared));
    };
    forEveryTarget([&](const char* target) {
      const std::vector<float> distance = fields::distance(set, size, glm::dvec3(0.5), 2),
                               both = fields::signedDistance(set, size, glm::dvec3(0.5), 2);
      for (std::size_t i = 0; i < set.size(); ++i) {
        ASSERT_FLOAT_EQ(distance[i], static_cast<float>(root(outside[i]))) << volume.name << " on " << target;
        ASSERT_FLOAT_EQ(both[i], static_cast<float>(set[i] ? -root(inside[i]) : root(outside[i])))
            << volume.name << " on " << target;
      }
    });
    if (HasFatalFailure()) return;
  }
}

TEST(Nearest, IsTheSameForAnyNumberOfThreads) {
  const auto volume = randomVolume({60, 50, 70}, 0.001, 8);
  const auto one = fields::nearestSet(volume.solid, volume.size, {1, 2, 3}, 1);
  for (const int threads : {0, 2, 5})
    EXPECT_EQ(fields::nearestSet(volume.solid, volume.size, {1, 2, 3}, threads), one);
}

TEST(Nearest, RefusesSpacingsThatAreNone) {
  const std::vector<std::uint8_t> set(8, 1);
  for (const double wrong : {0.0, -1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    EXPECT_THROW(fields::nearestSet(set, {2, 2, 2}, {1, wrong, 1}, 1), std::invalid_argument);
    EXPECT_THROW(fields::distance(set, {2, 2, 2}, glm::dvec3(wrong), 1), std::invalid_argument);
    EXPECT_THROW(fields::signedDistance(set, {2, 2, 2}, {1, 1, wrong}, 1), std::invalid_argument);
  }
  EXPECT_THROW(fields::nearestSet(set, {2, 2, 3}, {1, 1, 1}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test

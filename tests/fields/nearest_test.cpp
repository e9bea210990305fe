// SPDX-License-Identifier: MIT
// Nearest voxels, against all pairs.
#include <gtest/gtest.h>

#include "kelp/fields/fields.h"
#include "reference_fields.h"
#include "support/all_tests.h"
#include "volumes.h"

namespace kelp::test {
namespace {

// Compares the distances of nearestSet with brute force over all pairs.
void compare(const std::vector<std::uint8_t>& set, const glm::ivec3& size, const std::string& name) {
  const std::vector<std::uint32_t> nearest = fields::nearestSet(set, size, 2),
                                   squared = bruteSquaredDistance(set, size);
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (squared[i] == fields::kNoFeature) {
      ASSERT_EQ(nearest[i], fields::kNoFeature) << name;
      continue;
    }
    ASSERT_TRUE(set[nearest[i]]) << name;
    const glm::ivec3 gap = voxelAt(i, size) - voxelAt(nearest[i], size);
    ASSERT_EQ(gap.x * gap.x + gap.y * gap.y + gap.z * gap.z, static_cast<int>(squared[i])) << name;
  }
}

TEST(Nearest, IsAsNearAsAnyByBruteForce) {
  for (const double density : {0.0, 0.001, 0.02, 0.4, 1.0}) {
    const auto volume = randomVolume({17, 13, 11}, density, 3);
    compare(volume.solid, volume.size, std::to_string(density));
  }
}

// Lines, slices and shapes that break transforms: every hard volume of few enough voxels.
TEST(Nearest, IsAsNearAsAnyOnHardVolumes) {
  int checked = 0;
  for (const NamedVolume& volume : hardVolumes()) {
    if (volume.occupancy.solid.size() > 350) continue;
    ++checked;
    compare(volume.occupancy.solid, volume.occupancy.size, volume.name);
  }
  EXPECT_GT(checked, test::kSanitized ? 100 : 300);
}

TEST(Nearest, IsTheSameForAnyNumberOfThreads) {
  const auto volume = randomVolume({60, 50, 70}, 0.001, 8);
  const auto one = fields::nearestSet(volume.solid, volume.size, 1);
  for (const int threads : {0, 2, 5}) EXPECT_EQ(fields::nearestSet(volume.solid, volume.size, threads), one);
  EXPECT_THROW(fields::nearestSet(std::vector<std::uint8_t>(8), {2, 2, 3}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test

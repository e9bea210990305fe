// SPDX-License-Identifier: MIT
// Rays at 256 voxels (with KELP_ALL_TESTS half a million), in every pose of the paper's Figure 6, through
// several segments and random rigs: no owed hit missed, no hit invented. The words are those of
// reference/judge.h.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/trials.h"
#include "support/all_tests.h"
#include "support/poses.h"

namespace kelp {
namespace {

using reference::TrialTally;
using reference::TrialVolume;

// Posts of one voxel along each axis, far apart, and their stumps on the faces of the box.
fields::Occupancy thinPosts(const glm::ivec3& size) {
  return test::voxelsWhere(size, [&](const glm::ivec3& v) {
    return (v.x % 37 == 5 && v.z % 41 == 7) || (v.y % 43 == 11 && v.z % 53 == 30) ||
           (v.x % 47 == 21 && v.y % 59 == 2);
  });
}

// Spheres one voxel thick, one in the other.
fields::Occupancy shells(const glm::ivec3& size) {
  const glm::vec3 center = 0.5f * glm::vec3(size);
  return test::voxelsWhere(size, [&](const glm::ivec3& v) {
    const float d = glm::distance(glm::vec3(v) + 0.5f, center);
    return (std::abs(d - 40) < 0.6f || std::abs(d - 90) < 0.6f || std::abs(d - 120) < 0.6f) &&
           (v.x + 2 * v.y + 3 * v.z) % 29 > 3;
  });
}

// Single voxels in the outermost layers only: what a ray meets in its first and last instants.
fields::Occupancy endLayers(const glm::ivec3& size) {
  std::mt19937 random(3);
  return test::voxelsWhere(size, [&](const glm::ivec3& v) {
    const bool outermost =
        v.x == 0 || v.y == 0 || v.z == 0 || v.x == size.x - 1 || v.y == size.y - 1 || v.z == size.z - 1;
    return outermost && random() % 8 == 0;
  });
}

int raysOfEachRig() { return test::allTests() ? 9600 : 2000; }

// In volumes beyond 256 voxels.
int fewerRays() { return test::allTests() ? 9600 : 800; }

void expectExact(const TrialVolume& volume, int rays = raysOfEachRig()) {
  TrialTally all;
  unsigned seed = 1;
  for (const auto& rig : reference::namedRigs(volume.size))
    all.add(reference::runTrial(volume, rig, rays, seed++));
  for (unsigned i = 0; i < 3; ++i)
    all.add(reference::runTrial(volume, reference::randomRig(volume.size, 100 + i), rays, seed++));
  EXPECT_EQ(all.missed, 0u) << "of " << all.owed << " owed; " << all.first_failure;
  EXPECT_EQ(all.invented, 0u) << "of " << all.hits << " hits; " << all.first_failure;
  EXPECT_LE(1000 * all.depth_off, all.hits) << "hits more than half a voxel off";
  EXPECT_GT(all.owed, all.rays / 20) << "the rays hit too little to prove anything";
  EXPECT_LT(all.grazing, all.rays / 10);
  EXPECT_LT(all.steps_max, 1000);  // no ray stalls
  ::testing::Test::RecordProperty("rays", static_cast<int>(all.rays));
}

TEST(TraceTruth, ClumpAt256) {
  expectExact(reference::wholeVolume("clump", test::ballClump({256, 249, 195}, 30, 1)));
}
TEST(TraceTruth, NoiseAt256) {
  expectExact(reference::wholeVolume("noise", test::dust({256, 256, 163}, 3000, 2)));
}
TEST(TraceTruth, ThinPostsAt256) { expectExact(reference::wholeVolume("posts", thinPosts({256, 256, 180}))); }
TEST(TraceTruth, ShellsAt256) { expectExact(reference::wholeVolume("shells", shells({256, 256, 256}))); }
TEST(TraceTruth, EndLayersAt256) {
  expectExact(reference::wholeVolume("end layers", endLayers({256, 256, 256})));
}

TEST(TraceTruth, NoiseAt512) {
  expectExact(reference::wholeVolume("noise", test::dust({512, 361, 512}, 3000, 4)), fewerRays());
}
TEST(TraceTruth, VirtualAt4096) {
  expectExact(reference::tiledVolume("virtual", test::dust({64, 64, 64}, 20000, 5), {4096, 4096, 2048}),
              fewerRays());
}

void expectFewSteps(const glm::ivec3& size, double mean_allowed, int rays = 1500) {
  const TrialVolume volume = reference::wholeVolume("clump", test::ballClump(size, 30, 1));
  for (const auto& rig : reference::namedRigs(volume.size)) {
    const TrialTally tally = reference::runTrial(volume, rig, rays, 1);
    EXPECT_LT(static_cast<double>(tally.steps), mean_allowed * static_cast<double>(tally.rays)) << rig.name;
    EXPECT_LT(static_cast<double>(tally.outside), 4.0 * static_cast<double>(tally.rays)) << rig.name;
    EXPECT_LT(tally.steps_max, 150) << rig.name;
  }
}

TEST(TraceTruth, StepsAreFewInEveryPoseAt256) { expectFewSteps({256, 249, 195}, 10.5); }
TEST(TraceTruth, StepsAreFewInEveryPoseAt512) { expectFewSteps({512, 498, 390}, 1.1 * 10.5, 700); }

}  // namespace
}  // namespace kelp

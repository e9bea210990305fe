// SPDX-License-Identifier: MIT
// Rays through swept parts (with KELP_ALL_TESTS half a million), in nine named poses and in random ones: no
// owed hit missed, no hit invented. The words are those of reference/judge.h.
#include <gtest/gtest.h>

#include "reference/sweep_trials.h"
#include "support/all_tests.h"
#include "support/poses.h"

namespace kelp {
namespace {

using reference::SweepTally;
using reference::TrialVolume;

int sweptRays() { return test::allTests() ? 11000 : 2200; }       // of each rig
int fewerSweptRays() { return test::allTests() ? 11000 : 1100; }  // in the volumes that take longest

void expectExactSweeps(const TrialVolume& volume, int randoms, int rays = sweptRays()) {
  SweepTally all;
  unsigned seed = 1;
  for (const auto& rig : reference::namedSweeps(volume.size))
    all.add(reference::runSweepTrial(volume, rig, rays, seed++));
  for (int i = 0; i < randoms; ++i)
    all.add(reference::runSweepTrial(volume,
                                     reference::randomSweep(volume.size, 100 + static_cast<unsigned>(i)),
                                     std::max(rays / 10, 110), seed++));
  EXPECT_EQ(all.missed, 0u) << "of " << all.owed << " owed; " << all.first_failure;
  EXPECT_EQ(all.invented, 0u) << "of " << all.hits << " hits; " << all.first_failure;
  EXPECT_LE(1000 * all.depth_off, all.hits) << "hits more than half a voxel off";
  EXPECT_GT(all.owed, all.rays / 5) << "the rays hit too little to prove anything";
  EXPECT_LT(all.grazing, all.rays / 10);
  EXPECT_LT(all.steps_max, 2000);  // no ray stalls
  ::testing::Test::RecordProperty("rays", static_cast<int>(all.rays));
}

TEST(SweepTruth, ClumpAt256) {
  expectExactSweeps(reference::wholeVolume("clump", test::ballClump({72, 256, 64}, 30, 1)), 34);
}
TEST(SweepTruth, NoiseAt256) {
  expectExactSweeps(reference::wholeVolume("noise", test::dust({70, 256, 61}, 300, 2)), 33);
}
TEST(SweepTruth, NoiseAt512) {
  expectExactSweeps(reference::wholeVolume("noise", test::dust({140, 512, 101}, 300, 4)), 33,
                    fewerSweptRays());
}
TEST(SweepTruth, VirtualAt2048) {
  expectExactSweeps(reference::tiledVolume("virtual", test::dust({64, 64, 64}, 3000, 5), {512, 2048, 448}),
                    10, fewerSweptRays());
}

}  // namespace
}  // namespace kelp

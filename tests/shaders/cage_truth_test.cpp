// SPDX-License-Identifier: MIT
// Rays through caged parts, traced by the tree and walked from the boundary (with KELP_ALL_TESTS half a
// million), in named poses and with nodes moved at random: no owed hit missed, no hit invented. But walks may
// lose rays that are aimed at nodes, edges and faces of tetrahedra. The words are those of reference/judge.h.
#include <gtest/gtest.h>

#include <cmath>

#include "reference/cage_trials.h"
#include "support/all_tests.h"
#include "support/poses.h"

namespace kelp {
namespace {

using reference::CagedVolume;
using reference::CagePose;
using reference::CageTallies;
using reference::CageTally;

// Teeth closer than any cell is wide, on a bar.
fields::Occupancy comb(const glm::ivec3& size) {
  return test::voxelsWhere(size, [&](const glm::ivec3& v) { return v.y < 9 || v.x % 5 < 2; });
}
fields::Occupancy slab(const glm::ivec3& size) {
  return test::voxelsWhere(size, [](const glm::ivec3&) { return true; });
}
fields::Occupancy torus(const glm::ivec3& size) {
  const glm::vec3 center = 0.5f * glm::vec3(size);
  return test::voxelsWhere(size, [&](const glm::ivec3& v) {
    const glm::vec3 p = glm::vec3(v) + 0.5f - center;
    return std::hypot(std::hypot(p.x, p.y) - 0.33f * static_cast<float>(size.x), p.z) <
           0.16f * static_cast<float>(size.x);
  });
}
// Two legs, a voxel apart, and a body.
fields::Occupancy legs(const glm::ivec3& size) {
  return test::voxelsWhere(size, [&](const glm::ivec3& v) {
    const float half = 0.5f * static_cast<float>(size.x), z = 0.5f * static_cast<float>(size.z);
    const float x = static_cast<float>(v.x) + 0.5f, way = std::abs(x - half);
    if (3 * v.y > 2 * size.y) return std::hypot(way, static_cast<float>(v.z) + 0.5f - z) < half - 1;
    return way > 0.6f && std::hypot(way - 0.5f * half, static_cast<float>(v.z) + 0.5f - z) < 0.5f * half;
  });
}

// Of each pose: half a million of all tests, or ten million.
int cageRays() { return test::allTests() ? 60000 : 3300; }

CageTallies run(const CagedVolume& volume, const CagePose& pose, unsigned seed) {
  return reference::runCageTrial(volume, pose, test::shareOf(cageRays()), seed);
}

void expectExact(const CageTally& tally) {
  EXPECT_EQ(tally.missed, 0u) << "of " << tally.owed << " owed; " << tally.first_failure;
  EXPECT_EQ(tally.invented, 0u) << "of " << tally.hits << " hits; " << tally.first_failure;
  EXPECT_LE(tally.depth_off, tally.hits / 1000 + 1) << "hits more than half a voxel off";
  EXPECT_GT(tally.owed, tally.rays / 5) << "the rays hit too little to prove anything";
  EXPECT_LT(tally.grazing, tally.rays / 3);
}

void expectFewMissed(const CageTally& tally, double share) {
  EXPECT_EQ(tally.invented, 0u) << tally.first_failure;
  EXPECT_LE(static_cast<double>(tally.missed), 1 + share * static_cast<double>(tally.owed))
      << "of " << tally.owed << " owed; " << tally.first_failure;
}

// In all poses that fold nothing.
void expectExactCages(const CagedVolume& volume) {
  std::vector<CagePose> poses = reference::namedCagePoses(volume.size);
  poses.push_back(reference::shakenPose(0.2));
  CageTally walked, aimed;
  unsigned seed = 1;
  for (const CagePose& pose : poses) {
    const CageTallies tallies = run(volume, pose, seed++);
    EXPECT_EQ(tallies.traced.inverted, 0u) << pose.name;
    expectExact(tallies.traced);
    walked.add(tallies.walked);
    aimed.add(tallies.aimed);
  }
  EXPECT_EQ(walked.missed, 0u) << "of " << walked.owed << " owed; " << walked.first_failure;
  EXPECT_EQ(walked.invented, 0u) << walked.first_failure;
  // Nearly all of these rays pass an edge of the boundary exactly, where rounding may take a walk out.
  expectFewMissed(aimed, 0.0002);
}

// Of hits owed, at most so many may be missed: there is one farther away, or none.
struct MissedShares {
  double traced, walked, aimed;
};
constexpr MissedShares kWithinACell{0.002, 0.01, 0.02}, kWithinTwo{0.01, 0.17, 0.2};

// With inverted tetrahedra: nothing is invented, all walks end, and few hits are farther than the first one.
void expectEnds(const CagedVolume& volume, double shaken, const MissedShares& allowed) {
  // All rays, under sanitizers too: a share says nothing of some percents.
  const CageTallies tallies = reference::runCageTrial(volume, reference::shakenPose(shaken), cageRays(), 1);
  EXPECT_GT(tallies.traced.inverted, 0u);
  expectFewMissed(tallies.traced, allowed.traced);
  expectFewMissed(tallies.walked, allowed.walked);
  expectFewMissed(tallies.aimed, allowed.aimed);
}

fields::Occupancy clump(const glm::ivec3& size) { return test::ballClump(size, 30, 1); }

TEST(CageTruth, ClumpInCellsOf8) {
  expectExactCages(reference::cagedVolume("clump", clump({96, 128, 80}), 8));
}
TEST(CageTruth, ClumpInCellsOf4) {
  expectExactCages(reference::cagedVolume("clump", clump({60, 64, 50}), 4));
}
TEST(CageTruth, ClumpAt256) { expectExactCages(reference::cagedVolume("clump", clump({256, 249, 195}), 16)); }
TEST(CageTruth, DustInCellsOf2) {
  expectExactCages(reference::cagedVolume("dust", test::dust({40, 44, 30}, 300, 3), 2));
}
TEST(CageTruth, CombInCellsOf8) { expectExactCages(reference::cagedVolume("comb", comb({61, 50, 30}), 8)); }
TEST(CageTruth, CombInCellsOf16) {
  expectExactCages(reference::cagedVolume("comb", comb({61, 190, 30}), 16));
}
TEST(CageTruth, SlabInCellsOf4) { expectExactCages(reference::cagedVolume("slab", slab({48, 60, 12}), 4)); }
TEST(CageTruth, SlabInCellsOf8) { expectExactCages(reference::cagedVolume("slab", slab({61, 90, 29}), 8)); }
TEST(CageTruth, TorusInCellsOf8) {
  expectExactCages(reference::cagedVolume("torus", torus({90, 90, 34}), 8));
}
TEST(CageTruth, PlatesInCellsOf4) {
  expectExactCages(reference::cagedVolume("plates", test::platesAndRods({50, 61, 43}), 4));
}
TEST(CageTruth, LegsInCellsOf16) {
  expectExactCages(reference::cagedVolume("legs", legs({61, 130, 37}), 16));
}

// Of coarser levels, whose cells are larger, and whose voxels may be of several pieces.
TEST(CageTruth, CoarserLevels) {
  for (int level = 1; level < 4; ++level)
    expectExactCages(reference::cagedVolume("comb", comb({71, 290, 40}), 4, level));
  expectExactCages(reference::cagedVolume("legs", legs({71, 260, 43}), 16, 2));
}
// Where bricks are missing: coarser ones of the same cage, or nothing.
TEST(CageTruth, MissingBricks) {
  expectExactCages(reference::cagedVolume("clump", clump({96, 128, 80}), 16, 0, true));
  expectExactCages(reference::cagedVolume("comb", comb({61, 190, 30}), 16, 1, true));
  expectExactCages(reference::cagedVolume("legs", legs({61, 130, 37}), 8, 0, true));
}

// Nodes moved at random within a cube as large as a cell, and as two.
TEST(CageTruth, NodesWithinACell) {
  expectEnds(reference::cagedVolume("clump", clump({96, 128, 80}), 8), 1, kWithinACell);
  expectEnds(reference::cagedVolume("legs", legs({61, 130, 37}), 4), 1, kWithinACell);
  expectEnds(reference::cagedVolume("comb", comb({61, 50, 30}), 8), 1, kWithinACell);
}
TEST(CageTruth, NodesWithinTwoCells) {
  expectEnds(reference::cagedVolume("clump", clump({96, 128, 80}), 8), 2, kWithinTwo);
  expectEnds(reference::cagedVolume("torus", torus({90, 90, 34}), 4), 2, kWithinTwo);
}

}  // namespace
}  // namespace kelp

// SPDX-License-Identifier: MIT
// Rays through caged parts, traced by the tree and walked from the boundary (with KELP_ALL_TESTS half a
// million), in named poses and with nodes moved at random: no owed hit missed, no hit invented. The words are
// those of reference/judge.h.
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

template <class Solid>
fields::Occupancy solidWhere(const glm::ivec3& size, Solid&& solid) {
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) volume.solid[volume.index({x, y, z})] = solid(glm::ivec3(x, y, z));
  return volume;
}

// Teeth closer than any cell is wide, on a bar.
fields::Occupancy comb(const glm::ivec3& size) {
  return solidWhere(size, [&](const glm::ivec3& v) { return v.y < 9 || v.x % 5 < 2; });
}
fields::Occupancy slab(const glm::ivec3& size) {
  return solidWhere(size, [](const glm::ivec3&) { return true; });
}
fields::Occupancy torus(const glm::ivec3& size) {
  const glm::vec3 center = 0.5f * glm::vec3(size);
  return solidWhere(size, [&](const glm::ivec3& v) {
    const glm::vec3 p = glm::vec3(v) + 0.5f - center;
    return std::hypot(std::hypot(p.x, p.y) - 0.33f * static_cast<float>(size.x), p.z) <
           0.16f * static_cast<float>(size.x);
  });
}
// Two legs, a voxel apart, and a body.
fields::Occupancy legs(const glm::ivec3& size) {
  return solidWhere(size, [&](const glm::ivec3& v) {
    const float half = 0.5f * static_cast<float>(size.x), z = 0.5f * static_cast<float>(size.z);
    const float x = static_cast<float>(v.x) + 0.5f, way = std::abs(x - half);
    if (3 * v.y > 2 * size.y) return std::hypot(way, static_cast<float>(v.z) + 0.5f - z) < half - 1;
    return way > 0.6f && std::hypot(way - 0.5f * half, static_cast<float>(v.z) + 0.5f - z) < 0.5f * half;
  });
}

int cageRays() { return test::allTests() ? 3300 : 550; }

CageTallies run(const CagedVolume& volume, const std::vector<CagePose>& poses, int rays = cageRays()) {
  CageTallies all;
  unsigned seed = 1;
  for (const CagePose& pose : poses)
    all.add(reference::runCageTrial(volume, pose, test::shareOf(rays), seed++));
  return all;
}

void expectExact(const CageTally& tally) {
  EXPECT_EQ(tally.missed, 0u) << "of " << tally.owed << " owed; " << tally.first_failure;
  EXPECT_EQ(tally.invented, 0u) << "of " << tally.hits << " hits; " << tally.first_failure;
  EXPECT_LE(1000 * tally.depth_off, tally.hits) << "hits more than half a voxel off";
  EXPECT_GT(tally.owed, tally.rays / 5) << "the rays hit too little to prove anything";
  EXPECT_LT(tally.grazing, tally.rays / 10);
  EXPECT_LT(tally.steps_max, 2000);
  EXPECT_LT(tally.most_tetrahedra, 4096) << "a walk did not end by itself";
  ::testing::Test::RecordProperty("rays", static_cast<int>(tally.rays));
}

// In all poses that fold nothing.
void expectExactCages(const CagedVolume& volume, int rays = cageRays()) {
  std::vector<CagePose> poses = reference::namedCagePoses(volume.size);
  poses.push_back(reference::shakenPose(0.2));
  for (const CagePose& pose : poses) {
    const CageTallies tallies = run(volume, {pose}, rays);
    if (getenv("CAGE_VERBOSE")) {
      const auto& a = tallies.traced;
      const auto& b = tallies.walked;
      printf(
          "%-40s %-22s inv %5llu | traced rays %llu hits %llu owed %llu graz %llu missed %llu false %llu off "
          "%llu steps %.2f tets %.2f boxes %.2f inside %llu | walked owed %llu missed %llu false %llu steps "
          "%.2f tets %.2f most %d\n",
          volume.name.c_str(), pose.name.c_str(), (unsigned long long)a.inverted, (unsigned long long)a.rays,
          (unsigned long long)a.hits, (unsigned long long)a.owed, (unsigned long long)a.grazing,
          (unsigned long long)a.missed, (unsigned long long)a.invented, (unsigned long long)a.depth_off,
          double(a.steps) / double(a.rays), double(a.tetrahedra) / double(a.rays),
          double(a.outside) / double(a.rays), (unsigned long long)a.inside, (unsigned long long)b.owed,
          (unsigned long long)b.missed, (unsigned long long)b.invented, double(b.steps) / double(b.rays),
          double(b.tetrahedra) / double(b.rays), b.most_tetrahedra);
    }
    EXPECT_EQ(tallies.traced.inverted, 0u) << pose.name;
    expectExact(tallies.traced);
    expectExact(tallies.walked);
  }
}

TEST(CageTruth, ClumpInCellsOf8) {
  expectExactCages(reference::cagedVolume("clump", test::ballClump({96, 128, 80}, 30, 1), 8));
}
TEST(CageTruth, ClumpInCellsOf4) {
  expectExactCages(reference::cagedVolume("clump", test::ballClump({60, 64, 50}, 20, 2), 4));
}
TEST(CageTruth, LegsInCellsOf16) {
  expectExactCages(reference::cagedVolume("legs", legs({61, 130, 37}), 16));
}
TEST(CageTruth, CombInCellsOf8) { expectExactCages(reference::cagedVolume("comb", comb({61, 50, 30}), 8)); }

TEST(CageTruth, SlabInCellsOf4) { expectExactCages(reference::cagedVolume("slab", slab({48, 60, 12}), 4)); }
TEST(CageTruth, TorusInCellsOf8) {
  expectExactCages(reference::cagedVolume("torus", torus({90, 90, 34}), 8));
}

}  // namespace
}  // namespace kelp

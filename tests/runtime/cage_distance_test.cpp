// SPDX-License-Identifier: MIT
// distance() of parts with cages never exceeds the distance to the solid, and is not much less.
#include <gtest/gtest.h>

#include <cmath>

#include "caged_instance.h"
#include "expect_bounds.h"

namespace kelp::runtime {
namespace {

// Of each of 30 poses: a million in all, or some seconds' worth.
int cagedQueries() { return test::allTests() ? 35'000 : test::shareOf(2000); }

struct CagedDistanceQuery : testing::Test {
  test::CagedDistances legs{twoLegs({60, 80, 50}), 8};
};

// The medians at 2, 8 and 32 voxels.
void expectFineBounds(const test::CagedDistances& asset) {
  asset.inPoses([](const std::string& name, test::BentInstance& bent) {
    constexpr double kRest[3] = {0.5, 0.7, 0.5}, kBent[3] = {0.25, 0.35, 0.25};
    test::Quality quality;
    test::expectBounds(bent, cagedQueries(), &quality);
    quality.expectAtLeast(name.c_str(), name == "rest" ? kRest : kBent);
  });
}

TEST_F(CagedDistanceQuery, NeverExceedsTheTruth) { expectFineBounds(legs); }
TEST_F(CagedDistanceQuery, NeverExceedsTheTruthOfSmallCells) {
  expectFineBounds(test::CagedDistances(test::ballClump({60, 80, 50}, 20, 2), 4));
}
TEST_F(CagedDistanceQuery, NeverExceedsTheTruthOfABlock) {
  expectFineBounds(test::CagedDistances(test::hollowBlock(), 8));
}

TEST_F(CagedDistanceQuery, NeverExceedsTheTruthWithCoarserLevelsOnly) {
  for (const int finest : {1, 2, 3}) {
    const auto coarse = test::loadDistances(legs.source(), finest);
    for (const double shaken : {0.0, 0.7}) {
      SCOPED_TRACE(finest);
      const auto bent = legs.in(reference::shakenPose(shaken), *coarse,
                                test::turned(3, glm::vec3(2), {1, 2, 3}), static_cast<unsigned>(finest));
      test::expectBounds(*bent, cagedQueries() / 2);
    }
  }
}

// Depths that are stored reach two voxels. Those in the middle, where no cell is, count from the cells.
TEST_F(CagedDistanceQuery, KnowsHowDeepABlockIs) {
  const test::CagedDistances block(
      fields::Occupancy{glm::ivec3(64), std::vector<std::uint8_t>(64 * 64 * 64, 1)}, 8);
  const Instance instance{&*block};
  const glm::mat4 to_world = partToWorld(instance, 0).value();
  const auto depth = [&](const glm::vec3& p) {
    return -distance(instance, glm::vec3(to_world * glm::vec4(p, 1)))->bound / to_world[1].y;
  };
  for (int i = 1; i < 32; ++i) {
    const float at = static_cast<float>(i);
    EXPECT_GT(depth({at, 30.5f, 31}), i < 16 ? std::min(0.5f * at, 1.5f) : 0.49f * at) << i;
    EXPECT_LE(depth({at, 30.5f, 31}), at) << i;
  }
}

// A hole ends at a cube that has no cell: the surface there is only a face between cubes.
TEST_F(CagedDistanceQuery, NothingPassesTheEndOfAHole) {
  fields::Occupancy drilled{glm::ivec3(48), std::vector<std::uint8_t>(48 * 48 * 48, 1)};
  for (int i = 0; i < 8 * 4 * 4; ++i)
    drilled.solid[drilled.index(glm::ivec3(i % 8, 18 + i / 8 % 4, 18 + i / 32))] = 0;
  const test::CagedDistances asset(drilled, 8);
  const Instance instance{&*asset};
  const glm::mat4 to_world = partToWorld(instance, 0).value();
  const float voxel = to_world[1].y;
  const auto at = [&](float x) { return glm::vec3(to_world * glm::vec4(x, 20, 20, 1)); };
  const SphereCast cast = sphereCast(instance, at(-20), at(70), 0.5f * voxel).value();
  ASSERT_TRUE(cast.hit);
  EXPECT_LE(glm::distance(cast.center, at(7.5f)), voxel);
  EXPECT_LE(cast.center.x, at(7.5f).x);
  EXPECT_LE(distance(instance, at(7))->bound, voxel);
  EXPECT_GT(distance(instance, at(7))->bound, 0.5f * voxel);
  const ClosestPoint closest = closestPoint(instance, at(7.5f)).value();
  EXPECT_LT(glm::distance(closest.point, at(8)), 1e-3f * voxel);
  EXPECT_TRUE(overlaps(instance, Sphere{at(7.5f), 0.6f * voxel})->has_value());
  // In the solid beyond, a point is the nearest to itself, and everything overlaps.
  for (const float x : {8.5f, 12.0f, 24.0f, 43.0f}) {
    EXPECT_EQ(closestPoint(instance, at(x))->point, at(x)) << x;
    EXPECT_TRUE(overlaps(instance, Sphere{at(x), 0})->has_value()) << x;
    EXPECT_EQ(sphereCast(instance, at(x), at(x + 1), 0)->t, 0) << x;
  }
}

// Mirrored as a whole, nothing is drawn and nothing is solid; in part, nothing is that should not be.
TEST_F(CagedDistanceQuery, WhatIsTurnedInsideOutIsNoSolid) {
  const test::CagedDistances block(test::hollowBlock(), 8);
  const Part& part = (*block).pack().parts()[0];
  Pose pose = Pose::create(*block).value();
  const Instance instance{&*block, &pose};
  const auto nodes = pose.nodes(0);
  const glm::vec3 middle = part.to_object * glm::vec4(30, 36, 29, 1);
  EXPECT_LT(distance(instance, middle)->bound, 0);
  for (std::uint32_t i = 0; i < part.cages[0].nodes(); ++i)
    nodes[i] = glm::vec3(60, 0, 0) + glm::vec3(-1, 1, 1) * glm::vec3(part.cages[0].rest(i));
  pose.nodes(0);
  EXPECT_EQ(distance(instance, middle)->part, std::nullopt);
  EXPECT_EQ(closestPoint(instance, middle)->part, std::nullopt);
  EXPECT_FALSE(overlaps(instance, Sphere{middle, 100})->has_value());
  EXPECT_FALSE(sphereCast(instance, middle, middle + 1.0f, 0.1f)->hit);
}

}  // namespace
}  // namespace kelp::runtime

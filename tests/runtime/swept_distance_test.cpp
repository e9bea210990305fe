// SPDX-License-Identifier: MIT
// distance() of swept parts never exceeds the distance to the solid, and is not much less.
#include <gtest/gtest.h>

#include "expect_bounds.h"
#include "kelp/runtime/level.h"
#include "swept_instance.h"

namespace kelp::runtime {
namespace {

constexpr unsigned kRandomRigs = 16;
// Queries of each of the 25 poses: a million in all, or some seconds' worth.
int sweptQueries() { return test::allTests() ? 40'000 : test::shareOf(1500); }

constexpr double kLittle = 0.002;  // voxels: what inside is at least

struct SweptDistanceQuery : testing::Test {
  test::SweptVolume swept;
};

TEST_F(SweptDistanceQuery, NeverExceedsTheTruth) {
  constexpr double kLeast[3] = {0.3, 0.45, 0.35};
  swept.inPoses(kRandomRigs, [&](const std::string& name, test::BentInstance& bent) {
    test::Quality quality;
    test::expectBounds(bent, sweptQueries(), &quality);
    quality.expectAtLeast(name.c_str(), kLeast);
  });
}

TEST_F(SweptDistanceQuery, NeverExceedsTheTruthWithCoarserLevelsOnly) {
  for (const int finest : {1, 2, 3})
    swept.inPoses(
        0, [](const std::string&, test::BentInstance& bent) { test::expectBounds(bent, sweptQueries() / 3); },
        finest);
}

TEST_F(SweptDistanceQuery, NeverExceedsTheTruthWithOtherMatrices) {
  glm::mat4 sheared = test::turned(2, {1, 0.5f, 1}, {0, 0, 5});
  sheared[0] += 0.4f * sheared[1] - 0.3f * sheared[2];
  unsigned seed = 50;
  for (const reference::SweepRig& rig : swept.rigs(0)) {
    const test::SweptAsset asset(swept.pack, rig);
    for (const glm::mat4& matrix : {sheared, test::turned(4, {-1, 2, 1}, {1000, 20, -500})}) {
      SCOPED_TRACE(rig.name);
      test::BentInstance bent(*asset, swept.layers, rig.knots, matrix, seed++, rig.roll);
      test::expectBounds(bent, sweptQueries() / 3);
    }
  }
}

// Deep inside, next to a joint where a straight arc meets sharp ones: beyond it, holes are nearer than at
// rest.
TEST_F(SweptDistanceQuery, NeverExceedsTheDepthOfAPorousStem) {
  fields::Occupancy porous = test::dust({40, 120, 40}, 300, 4);
  for (std::uint8_t& solid : porous.solid) solid = !solid;
  const test::Layers layers(porous);
  reference::SweepRig rig{"stem", {{0, glm::vec3(0), {0, 1, 0}}}, 0};
  constexpr double kTurn = 2.6;
  for (int i = 0; i <= 3; ++i) {
    const double angle = kTurn * i / 3, radius = 0.5 / kTurn;
    rig.knots.push_back(
        {0.5f + static_cast<float>(i) / 6,
         glm::vec3(glm::dvec3(radius * (1 - std::cos(angle)), 0.5 + radius * std::sin(angle), 0)),
         glm::vec3(glm::dvec3(std::sin(angle), std::cos(angle), 0))});
  }
  const test::SweptAsset asset(test::distancePackOf(porous), rig);
  test::BentInstance bent(*asset, layers, rig.knots, glm::mat4(1), 4);
  test::expectBounds(bent, sweptQueries());
  // The holes are a solid whose distance is known.
  for (std::uint8_t& solid : porous.solid) solid = !solid;
  const test::Layers hole_layers(porous);
  const test::SweptTruth holes(hole_layers, rig.knots, 0);
  const glm::dmat4 to_world(partToWorld(bent.instance, 0).value()), to_part = glm::inverse(to_world);
  double deepest = 0;
  for (int i = 0; i < 5 * sweptQueries(); ++i) {
    const glm::vec3 rest(glm::dvec3(40 * bent.unit(), 56 + 8 * bent.unit(), 40 * bent.unit()) -
                         glm::dvec3(20, 0, 20));
    const glm::vec3 point = toWorld(bent.instance, 0, rest / 120.0f).value();
    const double depth = -double{distance(bent.instance, point)->bound} / bent.voxel;
    const glm::dvec3 in_part(to_part * glm::dvec4(point, 1));
    if (depth > kLittle) {
      ASSERT_LE(depth, glm::distance(in_part, holes.nearest(in_part)))
          << rest.x << " " << rest.y << " " << rest.z;
    }
    deepest = std::max(deepest, depth);
  }
  EXPECT_GT(deepest, 2);
}

// A thread one voxel wide, of which the lowest voxel is solid. Along it, stored distances are known to some
// percent, and arcs of up to 57 degrees shorten lengths by more to their chords.
TEST_F(SweptDistanceQuery, NeverExceedsAChord) {
  for (const int height : {8, 16, 30, 60}) {
    SCOPED_TRACE(height);
    fields::Occupancy thread{{1, height, 1}, std::vector<std::uint8_t>(static_cast<std::size_t>(height))};
    thread.solid[0] = 1;
    const test::Layers layers(thread);
    for (const double turn : {1.0, 1.57, 2.0}) {
      // A cubic that is nearly a circle.
      const double radius = 1 / turn, share = 4 * radius * std::tan(turn / 4);
      const glm::dvec3 top(radius * (1 - std::cos(turn)), radius * std::sin(turn), 0),
          end(std::sin(turn), std::cos(turn), 0);
      const reference::SweepRig rig{"thread",
                                    {{0, glm::vec3(0), glm::vec3(glm::dvec3(0, share, 0))},
                                     {1, glm::vec3(top), glm::vec3(share * end)}}};
      RawPack pack = test::distancePackOf(thread);
      pack.parts[0].distances[0] = fields::buildDistances(thread, kWidestBand, 1);
      const test::SweptAsset asset(pack, rig);
      test::BentInstance bent(*asset, layers, rig.knots, glm::mat4(1), 1);
      for (int y = 1; y < height; ++y) {
        const auto rest_y = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
        const glm::vec3 point = toWorld(bent.instance, 0, {0, rest_y, 0}).value();
        EXPECT_LE(double{distance(bent.instance, point)->bound}, bent.distanceOf(glm::dvec3(point))) << y;
      }
    }
  }
}

// A step along `away` grows the distance, a step back makes it less.
TEST_F(SweptDistanceQuery, PointsAway) {
  swept.inPoses(0, [](const std::string&, test::BentInstance& bent) {
    int farther = 0, nearer = 0, asked = 0;
    while (asked < 500) {
      const glm::vec3 point = bent.beside();
      const double here = bent.distanceOf(glm::dvec3(point));
      if (here < 1.5 * bent.voxel) continue;
      const glm::dvec3 step = 0.3 * here * glm::dvec3(distance(bent.instance, point)->away);
      ++asked;
      farther += bent.distanceOf(glm::dvec3(point) + step) > here;
      nearer += bent.distanceOf(glm::dvec3(point) - step) < here;
    }
    EXPECT_GT(farther, 450);
    EXPECT_GT(nearer, 450);
  });
}

// With a matrix that shears, the truth is still the distance to a point of the solid.
TEST_F(SweptDistanceQuery, ShearedShapesMissNothing) {
  glm::mat4 sheared = test::turned(2, {1, 0.5f, -1}, {0, 0, 5});
  sheared[0] += 0.4f * sheared[1] - 0.3f * sheared[2];
  unsigned seed = 80;
  for (const reference::SweepRig& rig : swept.rigs(2)) {
    SCOPED_TRACE(rig.name);
    const test::SweptAsset asset(swept.pack, rig);
    test::BentInstance bent(*asset, swept.layers, rig.knots, sheared, seed++, rig.roll);
    int touched = 0;
    for (int i = 0; i < sweptQueries() / 5; ++i) {
      const glm::vec3 point = bent.beside(3);
      const double truth = bent.distanceOf(glm::dvec3(point));
      const auto radius = static_cast<float>(truth * (0.5 + bent.unit()));
      const bool found = overlaps(bent.instance, Sphere{point, radius}).value().has_value();
      touched += found;
      ASSERT_TRUE(found || truth > double{radius});
      const ClosestPoint closest = *closestPoint(bent.instance, point);
      ASSERT_LE(double{closest.distance}, truth + bent.voxel);
      ASSERT_LE(bent.distanceOf(glm::dvec3(closest.point)), 0.01 * bent.voxel) << "not of the solid";
      const glm::vec3 target(bent.nearest(glm::dvec3(point)));
      if (glm::distance(point, target) < 1e-3f) continue;
      const SphereCast cast = *sphereCast(bent.instance, point, target, radius);
      ASSERT_TRUE(cast.hit) << "it ends on the solid";
      ASSERT_LE(double{cast.t} * truth, truth - double{radius} > 0 ? truth - double{radius} + 1e-6 : 0.0);
    }
    EXPECT_GT(touched, sweptQueries() / 10);
  }
}

// Where a coarse level is all there is, and as good as the finest: its voxels span much of the arcs.
TEST_F(SweptDistanceQuery, CoarseShapesMissNothing) {
  const fields::Occupancy coarse = test::dust({5, 18, 4}, 8, 6);
  fields::Occupancy blocks{8 * coarse.size, {}};
  for (int z = 0; z < blocks.size.z; ++z)
    for (int y = 0; y < blocks.size.y; ++y)
      for (int x = 0; x < blocks.size.x; ++x)
        blocks.solid.push_back(coarse.solid[coarse.index(glm::ivec3(x, y, z) / 8)]);
  const test::Layers layers(blocks);
  const RawPack pack = test::distancePackOf(blocks);
  unsigned seed = 30;
  for (const reference::SweepRig& rig : swept.rigs(4)) {
    SCOPED_TRACE(rig.name);
    const test::SweptAsset asset(pack, rig, 3);
    ASSERT_EQ((*asset).distances(0, 2), nullptr);
    test::BentInstance bent(*asset, layers, rig.knots, test::turned(3, glm::vec3(2), {1, 2, 3}), seed++,
                            rig.roll);
    for (int i = 0; i < sweptQueries(); ++i) {
      const glm::vec3 point = bent.beside(3);
      const double truth = bent.distanceOf(glm::dvec3(point));
      const auto radius = static_cast<float>(truth + 0.01 * bent.voxel);
      ASSERT_TRUE(*overlaps(bent.instance, Sphere{point, radius})) << truth / bent.voxel;
      ASSERT_LE(double{closestPoint(bent.instance, point)->distance}, truth + bent.voxel);
      const glm::vec3 target(bent.nearest(glm::dvec3(point)));
      if (truth < 0.1 * bent.voxel) continue;
      const SphereCast cast =
          *sphereCast(bent.instance, point, target, static_cast<float>(0.01 * bent.voxel));
      ASSERT_TRUE(cast.hit);
      ASSERT_LE(double{cast.t} * truth, truth - 0.009 * bent.voxel);
    }
  }
}

// The knots of the pack and its roll bend a part as the same ones of a pose do.
TEST_F(SweptDistanceQuery, BendsAtRestToo) {
  for (reference::SweepRig rig : swept.rigs(3)) {
    const test::SweptAsset straight(swept.pack, rig);
    Pose pose = *Pose::create(*straight);
    ASSERT_TRUE(pose.setKnots(0, rig.knots));
    pose.motion(0)->roll = rig.roll;
    RawPack bent_pack = swept.pack;
    bent_pack.parts[0].bend = Bend::kSweep;
    bent_pack.parts[0].knots = rig.knots;
    bent_pack.parts[0].roll = rig.roll;
    const std::vector<std::byte> bytes = test::bytesOf(bent_pack);
    const MemorySource source(bytes);
    const auto bent = test::loadDistances(source);
    const Instance posed{&*straight, &pose}, at_rest{bent.get()};
    const Box box = bounds(at_rest);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-0.2f, 1.2f);
    for (int i = 0; i < 100; ++i) {
      const glm::vec3 p = glm::mix(box.min, box.max, glm::vec3(unit(random), unit(random), unit(random)));
      EXPECT_EQ(distance(posed, p)->bound, distance(at_rest, p)->bound);
      EXPECT_EQ(closestPoint(posed, p)->distance, closestPoint(at_rest, p)->distance);
    }
  }
}

// Neither a swept part that folds nor any other part of its instance is drawn.
TEST_F(SweptDistanceQuery, WhatIsNotDrawnHasNoSolid) {
  const glm::vec3 point(0, 0.5f, 0);
  RawPack pack = swept.pack;
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "other";
  for (const int sweeps : {0, 1}) {
    pack.parts[0].bend = pack.parts[1].bend = Bend::kShear;
    pack.parts[static_cast<std::size_t>(sweeps)].bend = Bend::kSweep;
    const std::vector<std::byte> bytes = test::bytesOf(pack);
    const MemorySource source(bytes);
    const auto asset = test::loadDistances(source);
    Pose pose = *Pose::create(*asset);
    const Instance instance{asset.get(), &pose};
    const auto drawn = [&] {
      const bool found = distance(instance, point)->part.has_value();
      EXPECT_EQ(closestPoint(instance, point)->part.has_value(), found);
      EXPECT_EQ(overlaps(instance, Sphere{point, 1})->has_value(), found);
      EXPECT_EQ(overlaps(instance, Capsule{point, glm::vec3(1), 1})->has_value(), found);
      EXPECT_EQ(overlaps(instance, OrientedBox{point, glm::vec3(1)})->has_value(), found);
      EXPECT_EQ(sphereCast(instance, point, glm::vec3(1), 1)->hit, found);
      EXPECT_EQ(distance({&instance, 1}, point)->part.has_value(), found);
      return found;
    };
    EXPECT_TRUE(drawn());
    // Folds; points back along itself; no numbers; two knots on one point.
    for (const glm::vec3& tangent : {glm::vec3(20, 0.1f, 0), glm::vec3(0, -1, 0), glm::vec3(NAN, 1, 0),
                                     glm::vec3(0), glm::vec3(INFINITY)}) {
      pose.reset();
      ASSERT_TRUE(pose.setTangent(sweeps, 1, tangent));
      ASSERT_FALSE(pose.check());
      EXPECT_FALSE(drawn()) << sweeps;
    }
    pose.reset();
    ASSERT_TRUE(pose.move(sweeps, 1, {0, -1, 0}));
    EXPECT_FALSE(drawn());
    pose.reset();
    pose.motion(sweeps)->roll = NAN;
    EXPECT_FALSE(drawn());
    pose.reset();
    EXPECT_TRUE(drawn());
  }
}

}  // namespace
}  // namespace kelp::runtime

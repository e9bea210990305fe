// SPDX-License-Identifier: MIT
// Springs on the nodes of cages.
#include "kelp/runtime/spring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "bent_instance.h"
#include "caged_instance.h"

namespace kelp::runtime {
namespace {

// 40 x 60 x 40 voxels: a thick upright block with rounded corners, without a middle that has no cells.
fields::Occupancy cushion() {
  fields::Occupancy volume{glm::ivec3(40, 60, 40), std::vector<std::uint8_t>(40 * 60 * 40, 0)};
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 40; ++x) {
        const glm::vec3 off =
            glm::abs(glm::vec3(x, y, z) + 0.5f - glm::vec3(20, 30, 20)) - glm::vec3(8, 18, 8);
        if (glm::length(glm::max(off, 0.0f)) < 12) volume.solid[volume.index({x, y, z})] = 1;
      }
  return volume;
}

// The nodes of the finest cage with the spring.
std::vector<glm::vec3> sprung(const CagedAsset& asset, const Spring& spring, const Pose& without) {
  Pose pose = asset.pose();
  pose.assign(without).value();
  spring.addTo(pose).value();
  const auto nodes = std::as_const(pose).nodes(0);
  return {nodes.begin(), nodes.end()};
}

// The least distance from a point of the world to solid voxels' corners and centers, by their tetrahedra.
double toSolid(const CagedAsset& asset, const Instance& instance, const glm::vec3& center) {
  double least2 = INFINITY;
  const fields::Occupancy& volume = asset.volume;
  const PosedCage posed = posedCage(instance, 0, 0).value();
  const glm::mat4 to_world = partToWorld(instance, 0).value();
  for (std::uint32_t cell = 0; cell < posed.cage->cells(); ++cell) {
    const glm::ivec3 corner = posed.cage->side * posed.cage->place(cell);
    glm::vec3 at[8];
    for (int i = 0; i < 8; ++i) at[i] = posed.nodes[posed.cage->node(cell, i)];
    const int side = posed.cage->side;
    for (int i = 0; i < side * side * side; ++i) {
      const glm::ivec3 voxel = corner + glm::ivec3(i % side, i / side % side, i / side / side);
      if (glm::any(glm::greaterThanEqual(voxel, volume.size)) || !volume.solid[volume.index(voxel)]) continue;
      const glm::vec3 f = (glm::vec3(voxel - corner) + 0.5f) / static_cast<float>(side);
      // The tetrahedron by the order of the coordinates, largest first.
      int axes[3] = {0, 1, 2};
      std::sort(axes, axes + 3, [&](int a, int b) { return f[a] > f[b]; });
      int k = 0;
      glm::vec3 p = at[0];
      for (const int axis : axes) {
        p += f[axis] * (at[k | 1 << axis] - at[k]);
        k |= 1 << axis;
      }
      const glm::dvec3 off(glm::vec3(to_world * glm::vec4(p, 1)) - center);
      least2 = std::min(least2, glm::dot(off, off));
    }
  }
  return std::sqrt(least2);
}

// As many nodes as differ in a bit.
int changed(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof a[i]) != 0;
  return count;
}

// How far the solid is from a ball's center, in radii, with the spring. inverted: tetrahedra.
double radiiToSolid(const CagedAsset& asset, const Instance& instance, const Spring& spring,
                    const Sphere& ball, int& inverted) {
  Pose pose = asset.pose();
  pose.assign(*instance.pose).value();
  spring.addTo(pose).value();
  Instance with = instance;
  with.pose = &pose;
  inverted = static_cast<int>(posedCage(with, 0, 0)->inverted_count);
  return toSolid(asset, with, ball.center) / static_cast<double>(ball.radius);
}

// Poses of one cushion, each somewhere in the world.
struct PosedCushion {
  explicit PosedCushion(int cell, int kind)
      : asset(cushion(), cell, kind == 2 ? Bend::kShear : Bend::kSweep) {
    if (kind > 0) pose.setKnots(0, leaning()).value();
    if (kind == 3) shakeNodes(pose.nodes(0), 0.2f * static_cast<float>(cell), 7);
    if (kind > 0) {
      instance.to_world =
          test::turned(static_cast<float>(kind), glm::vec3(2, 2, kind % 2 == 0 ? -2 : 2), {3, 10, -7});
    }
    voxel = 2 / 60.0f * (kind > 0 ? 1.0f : 0.5f);
  }
  glm::vec3 at(const glm::vec3& rest) const {
    const Part& part = asset.part();
    return toWorld(instance, 0, part.to_object * glm::vec4(rest, 1)).value();
  }

  CagedAsset asset;
  Pose pose = asset.pose();
  Instance instance{&*asset, &pose};
  float voxel;
};

// Balls that come from the side, step by step.
TEST(CageSpring, WhatIsPushedLeavesTheBall) {
  for (const int cell : {4, 8})
    for (const int kind : {0, 1, 2, 3}) {
      const PosedCushion posed(cell, kind);
      for (const float size : {4.0f, 8.0f, 14.0f}) {
        SCOPED_TRACE(testing::Message() << "cells of " << cell << ", pose " << kind << ", ball " << size);
        Spring spring = *Spring::create(*posed.asset, {1.0f, 0.2f, 1.0f, true});
        ASSERT_TRUE(spring.setWind(0, {0, 0, kind > 0 ? 8.0f : 0.0f}));
        ASSERT_TRUE(spring.step(0.5f));
        int most_changed = 0;
        for (float in = 0; in <= 3 * size; in += 0.25f * size) {
          const Sphere ball{posed.at({40 + size - in, 38, 21}), size * posed.voxel};
          const auto before = sprung(posed.asset, spring, posed.pose);
          ASSERT_TRUE(spring.pushAway(posed.instance, ball.center, ball.radius));
          most_changed = std::max(most_changed, changed(before, sprung(posed.asset, spring, posed.pose)));
          int inverted = 0;
          EXPECT_GT(radiiToSolid(posed.asset, posed.instance, spring, ball, inverted), 0.99) << in;
          if (kind < 3 && in < 40) {  // no deeper than the cushion is
            EXPECT_EQ(inverted, 0) << in;
          }
        }
        EXPECT_GT(most_changed, 20);
      }
    }
}

// Also where a ball is all of a sudden, in cells or in the middle of the solid.
TEST(CageSpring, ABallInTheSolidIsLeftBySide) {
  for (const int cell : {4, 8}) {
    const PosedCushion posed(cell, 0);
    for (const float size : {4.0f, 8.0f, 14.0f})
      for (const float x : {36.0f, 30.0f, 20.0f}) {
        SCOPED_TRACE(testing::Message() << "cells of " << cell << ", ball " << size << " at " << x);
        Spring spring = *Spring::create(*posed.asset, {1.0f, 0.2f, 1.0f, true});
        const Sphere ball{posed.at({x, 38, 21}), size * posed.voxel};
        ASSERT_TRUE(spring.pushAway(posed.instance, ball.center, ball.radius));
        int inverted = 0;
        EXPECT_GT(radiiToSolid(posed.asset, posed.instance, spring, ball, inverted), 0.99);
        EXPECT_EQ(inverted, 0);
        for (std::uint32_t i = 0; i < posed.asset.part().cages[0].nodes(); ++i)
          if (posed.asset.part().cages[0].rest(i).y == 0) {
            EXPECT_EQ(spring.nodes(0)[i].offset, glm::vec3(0)) << "at the root";
          }
      }
  }
}

TEST(CageSpring, NodesBeyondReachAreTheSameBits) {
  for (const int kind : {0, 1, 2, 3}) {
    PosedCushion posed(4, kind);
    Spring spring = *Spring::create(*posed.asset);
    const float radius = 10 * posed.voxel;
    const auto before = sprung(posed.asset, spring, posed.pose);
    const glm::vec3 center = posed.at({46, 50, 20});
    ASSERT_TRUE(spring.pushAway(posed.instance, center, radius));
    ASSERT_TRUE(spring.step(0.02f));
    const auto after = sprung(posed.asset, spring, posed.pose);
    const glm::mat4 to_world = partToWorld(posed.instance, 0).value();
    int moved = 0, far = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const bool same = std::memcmp(&before[i], &after[i], sizeof before[i]) == 0;
      moved += !same;
      if (glm::distance(glm::vec3(to_world * glm::vec4(before[i], 1)), center) < 3.51f * radius) continue;
      ++far;
      EXPECT_TRUE(same) << i;
    }
    EXPECT_GT(moved, 30);
    EXPECT_GT(far, 100);
    // Beside it nothing moves, and the pose keeps its spline.
    Spring still = *Spring::create(*posed.asset);
    ASSERT_TRUE(still.pushAway(posed.instance, bounds(posed.instance).max + 0.6f * radius, radius));
    EXPECT_EQ(changed(before, sprung(posed.asset, still, posed.pose)), 0);
  }
  const CagedAsset asset(cushion(), 4, Bend::kShear);
  Pose pose = asset.pose();
  const Spring still = *Spring::create(*asset);
  ASSERT_TRUE(still.addTo(pose));
  pose.setKnots(0, leaning()).value();
  EXPECT_GT(changed(sprung(asset, still, asset.pose()), sprung(asset, still, pose)), 100)
      << "nodes follow the spline as before";
}

// x = e^(-z w t) (cos k t + z w / k sin k t), k = w sqrt(1 - z^2), from its start at rest.
TEST(CageSpring, NodesSwingBackAsTheEquationSays) {
  const PosedCushion posed(8, 0);
  const double omega = 2 * std::numbers::pi * 1.5, z = 0.25, k = omega * std::sqrt(1 - z * z);
  for (const int steps : {1, 2, 60}) {
    Spring spring = *Spring::create(*posed.asset, {1.5f, 0.25f});
    ASSERT_TRUE(spring.pushAway(posed.instance, posed.at({44, 50, 20}), 10 * posed.voxel));
    const std::vector<Swing> start(spring.nodes(0).begin(), spring.nodes(0).end());
    const double seconds = 0.4;
    for (int i = 0; i < steps; ++i) ASSERT_TRUE(spring.step(static_cast<float>(seconds / steps)));
    const double share =
        std::exp(-z * omega * seconds) * (std::cos(k * seconds) + z * omega / k * std::sin(k * seconds));
    float most = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      most = std::max(most, glm::length(start[i].offset));
      EXPECT_LT(glm::distance(spring.nodes(0)[i].offset, static_cast<float>(share) * start[i].offset), 2e-6f);
    }
    EXPECT_GT(most, 0.05f);
    const auto at_rest = sprung(posed.asset, *Spring::create(*posed.asset), posed.pose);
    EXPECT_GT(changed(at_rest, sprung(posed.asset, spring, posed.pose)), 20);
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(spring.step(0.25f));
    EXPECT_EQ(changed(at_rest, sprung(posed.asset, spring, posed.pose)), 0) << "at rest";
  }
}

// Without damping, for a long time, balls everywhere: no node has more energy than its reach allows.
TEST(CageSpring, EnergyIsBounded) {
  const PosedCushion posed(8, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> d(-1, 1);
  for (const bool rooted : {true, false}) {
    const float reach = 0.3f, frequency = 2;
    const float omega = 2 * std::numbers::pi_v<float> * frequency;
    Spring spring = *Spring::create(*posed.asset, {frequency, 0.0f, reach, rooted});
    int moved_roots = 0;
    for (int i = 0; i < test::shareOf(1500); ++i) {
      const glm::vec3 near =
          posed.at(glm::vec3(20, 30, 20) + 30.0f * glm::vec3(d(random), d(random), d(random)));
      ASSERT_TRUE(spring.pushAway(posed.instance, near, 12 * posed.voxel * (1 + d(random))));
      ASSERT_TRUE(spring.step(i % 7 == 0 ? 1000 * (1 + d(random)) : 0.02f));
      for (std::size_t n = 0; n < spring.nodes(0).size(); ++n) {
        const Swing& swing = spring.nodes(0)[n];
        const float energy =
            glm::dot(swing.offset, swing.offset) + glm::dot(swing.velocity, swing.velocity) / (omega * omega);
        ASSERT_LT(energy, 1.01f * reach * reach);
        if (posed.asset.part().cages[0].rest(static_cast<std::uint32_t>(n)).y == 0) moved_roots += energy > 0;
      }
    }
    EXPECT_EQ(moved_roots > 0, !rooted);
  }
}

TEST(CageSpring, BallsPushNoFartherThanReach) {
  const PosedCushion posed(8, 0);
  for (const float radius : {1.0f, 100.0f, 1e20f, 3e38f}) {
    Spring spring = *Spring::create(*posed.asset, {1.0f, 0.2f, 0.5f, true});
    ASSERT_TRUE(spring.pushAway(posed.instance, posed.at({50, 40, 20}), radius));
    float far = 0;
    for (const Swing& swing : spring.nodes(0)) far = std::max(far, glm::length(swing.offset));
    EXPECT_LT(far, 0.5f * 1.0001f) << radius;
    EXPECT_GT(far, 0.5f * 0.9f) << radius;
  }
}

TEST(CageSpring, BallsStopNodesThatComeTowardsThem) {
  const PosedCushion posed(8, 0);
  Spring spring = *Spring::create(*posed.asset, {1.0f, 0.2f, 1.0f, true});
  const glm::vec3 from_left = posed.at({-2, 50, 20});
  ASSERT_TRUE(spring.pushAway(posed.instance, from_left, 12 * posed.voxel));
  ASSERT_TRUE(spring.step(0.3f));
  const auto fastestLeft = [&] {
    float most = 0;
    for (const Swing& swing : spring.nodes(0)) most = std::max(most, -swing.velocity.x);
    return most;
  };
  const float before = fastestLeft();
  ASSERT_GT(before, 0.05f);
  ASSERT_TRUE(spring.pushAway(posed.instance, from_left, 20 * posed.voxel));
  EXPECT_LT(fastestLeft(), 0.5f * before);
}

// Nodes that the host wrote move with the knots' offsets, too: of a sheared part that rises evenly
// as its spline moves them.
TEST(CageSpring, KnotsMoveNodesOfTheHostToo) {
  const CagedAsset asset(cushion(), 4, Bend::kShear);
  Spring spring = *Spring::create(*asset);
  ASSERT_TRUE(spring.push(0, {1.5f, 0, -1}));
  ASSERT_TRUE(spring.step(0.2f));
  Pose following = asset.pose(), written = asset.pose();
  const std::vector<Knot> even = {{0, {0, 0, 0}, {0, 1, 0}},
                                  {0.5f, {0.1f, 0.5f, -0.06f}, {0.5f, 1, -0.1f}},
                                  {1, {0.45f, 1, 0}, {0.8f, 1, 0.3f}}};
  following.setKnots(0, even).value();
  ASSERT_TRUE(written.assign(following));
  static_cast<void>(written.nodes(0));
  const std::vector<glm::vec3> before(written.nodes(0).begin(), written.nodes(0).end());
  ASSERT_TRUE(spring.addTo(following));
  ASSERT_TRUE(spring.addTo(written));
  float most = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (asset.part().cages[0].rest(static_cast<std::uint32_t>(i)).y > 59) continue;
    const glm::vec3 node = std::as_const(written).nodes(0)[i];
    EXPECT_LT(glm::distance(node, std::as_const(following).nodes(0)[i]), 2e-4f) << i;
    most = std::max(most, glm::distance(node, before[i]));
  }
  EXPECT_GT(most, 3);
}

TEST(CageSpring, NothingAbsurdMakesNumbersThatAreNone) {
  const CagedAsset asset(twoLegs({26, 40, 24}), 4, Bend::kSweep);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto any = [&] { return unit(random) * std::pow(10.0f, 38 * unit(random)); };
  for (const float damping : {0.0f, 0.3f, 3e38f}) {
    for (const float frequency : {1e-30f, 1.0f, 10000.0f}) {
      Spring spring = *Spring::create(*asset, {frequency, damping});
      Pose pose = asset.pose();
      for (int i = 0; i < 60; ++i) {
        pose.reset();
        if (i % 5 == 0) shakeNodes(pose.nodes(0), std::abs(any()), static_cast<unsigned>(i));
        if (i % 11 == 0) pose.nodes(0)[3].y = std::numeric_limits<float>::quiet_NaN();
        Instance instance{&*asset, i % 4 == 0 ? nullptr : &pose};
        if (i % 7 == 0) instance.to_world = glm::mat4(any());
        const glm::vec3 center = i % 2 ? glm::vec3(any(), any(), any()) : glm::vec3(0.1f, 0.5f, 0);
        ASSERT_TRUE(spring.pushAway(instance, center, std::abs(any())));
        ASSERT_TRUE(spring.step(std::abs(any())));
        for (const Swing& swing : spring.nodes(0))
          ASSERT_TRUE(std::isfinite(glm::dot(swing.offset, swing.offset)) &&
                      std::isfinite(swing.velocity.x + swing.velocity.y + swing.velocity.z));
        ASSERT_TRUE(spring.addTo(pose));
        ASSERT_TRUE(pose.check()) << i;
      }
    }
  }
}

TEST(CageSpring, MisuseIsAnswered) {
  const CagedAsset asset(cushion(), 8, Bend::kSweep), finer(cushion(), 4, Bend::kSweep);
  Loaded plain(test::packOf(cushion(), straight({0, 0.5f, 1})));
  Spring spring = *Spring::create(*asset);
  Pose fine = finer.pose(), without = *Pose::create(*plain.asset);
  for (Pose* const foreign : {&fine, &without}) {
    EXPECT_EQ(spring.addTo(*foreign).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(spring.pushAway({&*asset, foreign}, {0, 0, 0}, 1).error().code, ErrorCode::kMisuse);
  }
  for (const Asset* const foreign : std::initializer_list<const Asset*>{&*finer, &*plain.asset})
    EXPECT_EQ(spring.pushAway({foreign, nullptr}, {0, 0, 0}, 1).error().code, ErrorCode::kMisuse);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {nan, HUGE_VALF}) {
    EXPECT_EQ(spring.pushAway({&*asset, nullptr}, {0, bad, 0}, 1).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(spring.pushAway({&*asset, nullptr}, {0, 0, 0}, bad).error().code, ErrorCode::kMisuse);
  }
  for (const float none : {0.0f, -1.0f}) EXPECT_TRUE(spring.pushAway({&*asset, nullptr}, {0, 0.5f, 0}, none));
  for (const Swing& swing : spring.nodes(0)) EXPECT_EQ(swing.offset, glm::vec3(0));
  EXPECT_EQ(spring.nodes(0).size(), asset.part().cages[0].nodes());
  for (const int part : {-1, 1}) EXPECT_TRUE(spring.nodes(part).empty());
  EXPECT_TRUE(Spring::create(*plain.asset)->nodes(0).empty());
  ASSERT_TRUE(spring.pushAway({&*asset, nullptr}, {0, 0.5f, 0}, 0.2f));
  EXPECT_NE(sprung(asset, spring, asset.pose()), sprung(asset, *Spring::create(*asset), asset.pose()));
  spring.reset();
  for (const Swing& swing : spring.nodes(0)) EXPECT_EQ(swing.offset, glm::vec3(0));
}

TEST(CageSpring, AllocatesOnlyWhereItIsCreated) {
  const CagedAsset asset(cushion(), 8, Bend::kSweep);
  int calls = 0;
  Allocator counting;
  counting.user = &calls;
  counting.allocate = [](void* user, std::size_t bytes) {
    ++*static_cast<int*>(user);
    return std::malloc(bytes);
  };
  Spring spring = *Spring::create(*asset, {}, counting);
  Pose pose = *Pose::create(*asset, counting);
  const int created = calls;
  for (int i = 0; i < 4; ++i) {
    pose.reset();
    ASSERT_TRUE(spring.step(0.1f));
    ASSERT_TRUE(spring.pushAway({&*asset, &pose}, {0, 0.5f, 0}, 0.3f));
    ASSERT_TRUE(spring.addTo(pose));
  }
  EXPECT_EQ(calls, created);
}

}  // namespace
}  // namespace kelp::runtime

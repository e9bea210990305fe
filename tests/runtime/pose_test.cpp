// SPDX-License-Identifier: MIT
#include "kelp/runtime/pose.h"
#include "support/edit_knots.h"
#include "support/voxel_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "kelp/runtime/instance.h"
#include "loaded.h"

namespace kelp::runtime {
namespace {

RawPack animated() {
  RawPack pack = test::packOf(test::ballClump({24, 40, 24}, 8, 1));
  RawClip clip;
  clip.name = "sway";
  clip.duration = 4;
  clip.waves.push_back({0, 1, Target::kKnotOffset, {6, 0, -2}, 4.0f, 0.25f});
  RawTrack track;
  track.knot = 1;
  track.target = Target::kKnotTangent;
  track.interpolation = Interpolation::kLinear;
  track.keys = {{1, {0, 0, 0, 0}, {}, {}}, {3, {10, 0, 0, 0}, {}, {}}};
  clip.tracks.push_back(track);
  RawTrack turn;
  turn.target = Target::kPartRotation;
  turn.keys = {{0, {0, 0, 0, 1}, {}, {}}, {4, {0, std::sin(0.5f), 0, std::cos(0.5f)}, {}, {}}};
  clip.tracks.push_back(turn);
  RawTrack smooth;
  smooth.knot = 0;
  smooth.target = Target::kKnotOffset;
  smooth.interpolation = Interpolation::kCubic;
  smooth.keys = {{0, {0, 0, 0, 0}, {}, {1, 0, 0, 0}}, {2, {4, 0, 0, 0}, {-1, 0, 0, 0}, {0, 0, 0, 0}}};
  clip.tracks.push_back(smooth);
  pack.clips.push_back(clip);
  return pack;
}

TEST(Pose, StartsAtRestAndReturns) {
  Loaded loaded(animated());
  Result<Pose> pose = Pose::create(*loaded.asset);
  ASSERT_TRUE(pose);
  ASSERT_EQ(pose->knots(0).size(), 2u);
  EXPECT_EQ(pose->knots(0)[1].position, glm::vec3(0, 1, 0));
  test::edit(*pose, 0)[1].position.x = 9;
  pose->motion(0)->translation.y = 2;
  pose->reset();
  EXPECT_EQ(pose->knots(0)[1].position, glm::vec3(0, 1, 0));
  EXPECT_EQ(pose->motion(0)->translation, glm::vec3(0));
  EXPECT_TRUE(pose->knots(1).empty());
  EXPECT_TRUE(pose->knots(-1).empty());
  EXPECT_EQ(pose->motion(1), nullptr);
  EXPECT_EQ(pose->motion(-1), nullptr);
}

TEST(Pose, AddsClips) {
  Loaded loaded(animated());
  Pose pose = *Pose::create(*loaded.asset);
  ASSERT_EQ(findClip(*loaded.asset, "sway").value(), 0);
  const Result<int> absent = findClip(*loaded.asset, "absent");
  ASSERT_FALSE(absent);
  EXPECT_STREQ(absent.error().detail, "there is no clip of that name; there are: sway");
  ASSERT_TRUE(addClip(*loaded.asset, 0, 0.0, 1.0f, pose));  // the wave's phase is a quarter turn: its crest
  EXPECT_NEAR(pose.knots(0)[1].position.x, 6.0f, 1e-5f);
  EXPECT_NEAR(pose.knots(0)[1].position.z, -2.0f, 1e-5f);
  pose.reset();
  ASSERT_TRUE(addClip(*loaded.asset, 0, 2.0, 0.5f, pose));
  EXPECT_NEAR(pose.knots(0)[1].position.x, -3.0f, 1e-5f);
  EXPECT_NEAR(pose.knots(0)[1].tangent.x, 2.5f, 1e-5f);  // half of the half-way value
  const float angle = 2.0f * std::asin(pose.motion(0)->rotation.y);
  EXPECT_NEAR(angle, 0.25f, 1e-4f);  // half-way of one radian, half weight
  pose.reset();
  ASSERT_TRUE(addClip(*loaded.asset, 0, 1.0, 1.0f, pose));
  // Hermite at its middle
  EXPECT_NEAR(pose.knots(0)[0].position.x, 0.5f * 4 + 0.125f * 2 * 1 - 0.125f * 2 * -1, 1e-5f);
  pose.reset();
  ASSERT_TRUE(addClip(*loaded.asset, 0, -3.0, 1.0f, pose));  // wraps to 1
  EXPECT_NEAR(pose.knots(0)[0].position.x, 2.5f, 1e-4f);
}

TEST(Pose, MisuseIsAnswered) {
  Loaded loaded(animated());
  Loaded other(test::packOf(test::ballClump({24, 40, 24}, 8, 1), straight({0, 0.5f, 1})));
  Pose pose = *Pose::create(*loaded.asset);
  Pose wrong = *Pose::create(*other.asset);
  EXPECT_EQ(addClip(*loaded.asset, 5, 0, 1, pose).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(addClip(*loaded.asset, 0, 0, 1, wrong).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(addClip(*loaded.asset, 0, std::nan(""), 1, pose).error().code, ErrorCode::kMisuse);
  EXPECT_FALSE(pose.assign(wrong));
  Pose copy = *Pose::create(*loaded.asset);
  test::edit(copy, 0, 40)[1].position.x = 3;
  EXPECT_TRUE(pose.assign(copy));
  EXPECT_EQ(pose.knots(0)[1].position.x, 3.0f / 40);
}

TEST(Pose, CheckRefusesAndClampMends) {
  Loaded loaded(animated());
  Pose pose = *Pose::create(*loaded.asset);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> d(-200, 200);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    pose.reset();
    for (Knot& knot : test::edit(pose, 0, 40)) {
      knot.position += glm::vec3(d(random), 0.3f * d(random), d(random));
      knot.tangent += glm::vec3(d(random), d(random), d(random));
    }
    const bool sound = static_cast<bool>(pose.check());
    refused += !sound;
    const Knot before = pose.knots(0)[1];
    pose.clamp();
    ASSERT_TRUE(pose.check()) << i;
    EXPECT_EQ(pose.knots(0)[1].position.x, before.position.x);
    if (sound) {
      EXPECT_EQ(pose.knots(0)[1].tangent, before.tangent) << "a sound pose is left alone";
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(Pose, ClampMendsManyKnots) {
  std::vector<Knot> knots;
  for (const float at : {0.0f, 0.2f, 0.35f, 0.8f, 1.0f}) knots.push_back({at, {0, at, 0}, {0, 1, 0}});
  Loaded loaded(test::packOf(test::ballClump({24, 40, 24}, 8, 1), knots));
  Pose pose = *Pose::create(*loaded.asset);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> d(-100, 200);
  for (int i = 0; i < 100000; ++i) {
    pose.reset();
    for (Knot& knot : test::edit(pose, 0, 40)) {
      knot.position.y += 0.1f * d(random);
      knot.tangent.y = d(random);
    }
    pose.clamp();
    ASSERT_TRUE(pose.check()) << i;
  }
}

// Numbers that are none are an error wherever they are, not something to clamp; what asks about such a pose
// answers that there is nothing.
TEST(Pose, NumbersThatAreNoneAreRefused) {
  Loaded loaded(animated());
  Pose pose = *Pose::create(*loaded.asset);
  const Instance instance{loaded.asset.get(), &pose};
  const Ray down{{0, 10, 0}, {0, -1, 0}};
  ASSERT_TRUE(raycast(instance, down));
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    for (std::size_t knot = 0; knot < 2; ++knot) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const bool tangent : {true, false}) {
          SCOPED_TRACE(testing::Message() << bad << " in knot " << knot << ", axis " << axis
                                          << (tangent ? ", tangent" : ", position"));
          pose.reset();
          Knot changed = pose.knots(0)[knot];
          (tangent ? changed.tangent : changed.position)[axis] = bad;
          test::edit(pose, 0)[knot] = changed;
          ASSERT_FALSE(pose.check());
          EXPECT_EQ(pose.check().error().code, ErrorCode::kMisuse);
          EXPECT_FALSE(raycast(instance, down));
          EXPECT_FALSE(toRest(instance, 0, {0, 0.5f, 0}));
          pose.clamp();  // ends, whatever it was given
        }
      }
    }
  }
  pose.reset();
  EXPECT_TRUE(raycast(instance, down));
}

// A pose that a host drags out of a slider is refused with the part, until the host asks for the clamp.
TEST(Pose, ATurningPoseNamesItsPart) {
  RawPack pack = test::packOf(test::ballClump({24, 40, 24}, 8, 1));
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "second";
  Loaded loaded(pack);
  Pose pose = *Pose::create(*loaded.asset);
  test::edit(pose, 1, 40)[0].tangent.y = -60;
  ASSERT_FALSE(pose.check());
  EXPECT_EQ(pose.check().error().code, ErrorCode::kNotMonotone);
  EXPECT_EQ(pose.check().error().offset, 1u);
  pose.clamp();
  EXPECT_TRUE(pose.check());
}

TEST(Instance, RestPointsGoToTheWorldAndBack) {
  Loaded loaded(animated());
  Pose pose = *Pose::create(*loaded.asset);
  test::edit(pose, 0, 40)[0].tangent = {120, 0, 40};
  test::edit(pose, 0, 40)[1].tangent = {120, 0, 80};
  test::edit(pose, 0, 40)[1].position = {10, 55, -5};
  pose.motion(0)->translation = {0.2f, 0, 0};
  pose.motion(0)->rotation = glm::angleAxis(0.5f, glm::vec3(0, 0, 1));
  ASSERT_TRUE(pose.check());
  Instance instance{loaded.asset.get(), &pose};
  instance.to_world[3] = {5, -2, 1, 1};
  instance.to_world[0].x = -2;  // mirrored and stretched
  const Box box = bounds(instance);
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 voxel(24 * unit(random), 40 * unit(random), 24 * unit(random));
    const glm::vec3 rest = test::voxelToRest(instance, 0, voxel);
    const glm::vec3 world = toWorld(instance, 0, rest).value();
    for (int a = 0; a < 3; ++a) {
      EXPECT_GE(world[a], box.min[a] - 1e-4f);
      EXPECT_LE(world[a], box.max[a] + 1e-4f);
    }
    const auto back = toRest(instance, 0, world);
    ASSERT_TRUE(back);
    EXPECT_LT(glm::distance(test::restToVoxel(instance, 0, *back), voxel), 2e-2f);
    const glm::mat4 frame = frameAt(instance, 0, rest).value();
    EXPECT_LT(glm::distance(glm::vec3(frame[3]), world), 1e-5f);
    EXPECT_NEAR(glm::determinant(glm::mat3(frame)), 1.0f, 1e-4f);
    // y runs along the spline: where a point a little higher goes.
    const glm::vec3 above = test::voxelToWorld(instance, 0, voxel + glm::vec3(0, 1e-2f, 0)) - world;
    if (voxel.y > 2 && voxel.y < 38) {
      EXPECT_GT(glm::dot(glm::normalize(above), glm::vec3(frame[1])), 0.99f);
    }
  }
  EXPECT_FALSE(toRest(instance, 0, {1e6f, 1e6f, 0}));
}

}  // namespace
}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// Poses between poses, layers of clips, masks.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "kelp/runtime/pose.h"
#include "loaded.h"
#include "support/edit_knots.h"
#include "support/voxel_knots.h"

namespace kelp::runtime {
namespace {

RawPack twoParts() {
  RawPack pack = reed({0, 0.4f, 1});
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "second";
  for (const char* name : {"left", "right"}) {
    const float sign = name[0] == 'l' ? -1.0f : 1.0f;
    RawClip clip;
    clip.name = name;
    clip.duration = 2;
    for (std::uint32_t part = 0; part < 2; ++part) {
      clip.waves.push_back({part, 2, Target::kKnotOffset, {9 * sign, 0, 3}, sign > 0 ? 2.0f : 1.6f, 0.2f});
      clip.waves.push_back({part, 1, Target::kKnotTangent, {12, 0, 7 * sign}, 2.0f, 0.6f});
    }
    pack.clips.push_back(clip);
  }
  return pack;
}

// The knots of all parts, in voxels.
std::vector<Knot> allKnots(const Pose& pose) {
  std::vector<Knot> all;
  for (int part = 0; part < pose.parts(); ++part)
    for (const Knot& knot : test::inVoxels(pose.knots(part), 40)) all.push_back(knot);
  return all;
}

void shake(Pose& pose, std::mt19937& random) {
  std::uniform_real_distribution<float> d(-1, 1);
  for (int part = 0; part < pose.parts(); ++part) {
    for (Knot& knot : test::edit(pose, part, 40)) {
      knot.position += 20.0f * glm::vec3(d(random), 0.2f * d(random), d(random));
      knot.tangent += 60.0f * glm::vec3(d(random), d(random), d(random));
    }
    *pose.motion(part) = {{d(random), d(random), d(random)},
                          glm::normalize(glm::quat(d(random), d(random), d(random), d(random))),
                          glm::vec3(1.5f + d(random))};
  }
}

// Rotation by the angle between two unit quaternions, in double precision.
double angleBetween(const glm::quat& a, const glm::quat& b) {
  const glm::dquat difference = glm::conjugate(glm::dquat(a)) * glm::dquat(b);
  return 2 * std::atan2(glm::length(glm::dvec3(difference.x, difference.y, difference.z)),
                        std::abs(difference.w));
}

TEST(Blend, GoesStraightAndTurnsEvenly) {
  Loaded loaded(twoParts());
  Pose a = *Pose::create(*loaded.asset), b = *Pose::create(*loaded.asset),
       pose = *Pose::create(*loaded.asset);
  std::mt19937 random(11);
  for (int n = 0; n < 50; ++n) {
    a.reset();
    b.reset();
    shake(a, random);
    shake(b, random);
    for (const float w : {0.0f, 0.25f, 0.7f, 1.0f}) {
      ASSERT_TRUE(pose.assign(a));
      ASSERT_TRUE(pose.blend(b, w));
      for (std::size_t i = 0; i < allKnots(pose).size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          const auto mixed = [w](float x, float y) {
            return static_cast<double>(x) +
                   static_cast<double>(w) * (static_cast<double>(y) - static_cast<double>(x));
          };
          EXPECT_NEAR(allKnots(pose)[i].position[axis],
                      mixed(allKnots(a)[i].position[axis], allKnots(b)[i].position[axis]), 1e-5);
          EXPECT_NEAR(allKnots(pose)[i].tangent[axis],
                      mixed(allKnots(a)[i].tangent[axis], allKnots(b)[i].tangent[axis]), 4e-5);
        }
        EXPECT_EQ(allKnots(pose)[i].at, allKnots(a)[i].at);
      }
      for (int part = 0; part < 2; ++part) {
        const glm::quat q = pose.motion(part)->rotation;
        const double whole = angleBetween(a.motion(part)->rotation, b.motion(part)->rotation);
        EXPECT_NEAR(glm::length(q), 1.0f, 1e-6f);
        EXPECT_NEAR(angleBetween(a.motion(part)->rotation, q), static_cast<double>(w) * whole, 2e-3);
        EXPECT_NEAR(angleBetween(q, b.motion(part)->rotation), (1 - static_cast<double>(w)) * whole, 2e-3);
        EXPECT_LT(glm::distance(pose.motion(part)->scale,
                                glm::mix(a.motion(part)->scale, b.motion(part)->scale, w)),
                  1e-6f);
        EXPECT_LT(glm::distance(pose.motion(part)->translation,
                                glm::mix(a.motion(part)->translation, b.motion(part)->translation, w)),
                  1e-6f);
      }
    }
  }
}

TEST(Blend, BetweenMonotonePosesIsMonotone) {
  Loaded loaded(twoParts());
  Pose a = *Pose::create(*loaded.asset), b = *Pose::create(*loaded.asset);
  std::mt19937 random(12);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int n = 0; n < 2000; ++n) {
    a.reset();
    b.reset();
    shake(a, random);
    shake(b, random);
    a.clamp();
    b.clamp();
    ASSERT_TRUE(a.blend(b, unit(random)));
    ASSERT_TRUE(a.check()) << n;
  }
}

TEST(Blend, MasksParts) {
  Loaded loaded(twoParts());
  Pose a = *Pose::create(*loaded.asset), b = *Pose::create(*loaded.asset);
  test::edit(b, 0)[2].position.x = 8;
  test::edit(b, 1)[2].position.x = 8;
  ASSERT_TRUE(a.blend(b, 0.5f, std::array{0.0f, 0.5f}));
  EXPECT_EQ(a.knots(0)[2].position.x, 0.0f);
  EXPECT_EQ(a.knots(1)[2].position.x, 2.0f);
}

// Weights that add up to one: what two clips do together is between what they do alone, at every moment.
TEST(Blend, ACrossfadeOfClipsIsTheBlendOfTheirPoses) {
  Loaded loaded(twoParts());
  Pose left = *Pose::create(*loaded.asset), right = *Pose::create(*loaded.asset),
       faded = *Pose::create(*loaded.asset);
  for (int i = 0; i <= 40; ++i) {
    const float w = static_cast<float>(i) / 40;
    const double seconds = 0.1 * i;
    left.reset();
    right.reset();
    faded.reset();
    ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 1, left));
    ASSERT_TRUE(addClip(*loaded.asset, 1, seconds, 1, right));
    ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 1 - w, faded));
    ASSERT_TRUE(addClip(*loaded.asset, 1, seconds, w, faded));
    ASSERT_TRUE(left.blend(right, w));
    for (std::size_t k = 0; k < allKnots(faded).size(); ++k) {
      EXPECT_LT(glm::distance(allKnots(faded)[k].position, allKnots(left)[k].position), 1e-4f);
      EXPECT_LT(glm::distance(allKnots(faded)[k].tangent, allKnots(left)[k].tangent), 1e-4f);
    }
  }
}

TEST(Blend, MisuseIsAnsweredAndChangesNothing) {
  Loaded loaded(twoParts()), other(reed({0, 1}));
  Pose pose = *Pose::create(*loaded.asset), to = *Pose::create(*loaded.asset),
       foreign = *Pose::create(*other.asset);
  test::edit(to, 0)[1].position.x = 5;
  EXPECT_EQ(pose.blend(foreign, 0.5f).error().code, ErrorCode::kMisuse);
  for (const float w : {-0.1f, 1.1f, std::nanf(""), HUGE_VALF}) {
    EXPECT_EQ(pose.blend(to, w).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(pose.blend(to, 1, std::array{1.0f, w}).error().code, ErrorCode::kMisuse);
  }
  EXPECT_EQ(pose.blend(to, 1, std::array{1.0f}).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(pose.knots(0)[1].position.x, 0.0f);
  EXPECT_TRUE(pose.fits(*loaded.asset));
  EXPECT_FALSE(foreign.fits(*loaded.asset));
  Pose moved = std::move(pose);
  EXPECT_EQ(pose.parts(), 0);  // NOLINT: a pose that was moved from is empty, not undefined
  EXPECT_TRUE(pose.knots(0).empty());
  pose.reset();
  EXPECT_EQ(moved.parts(), 2);
}

}  // namespace
}  // namespace kelp::runtime

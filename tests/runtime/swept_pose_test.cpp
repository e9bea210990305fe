// SPDX-License-Identifier: MIT
// Functions of poses of swept parts: points there and back, frames, sockets, blends, clamps and springs.
// The truth is that of tests/reference.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "kelp/runtime/spring.h"
#include "swept_instance.h"

namespace kelp::runtime {
namespace {

using glm::dvec3;

struct SweptPose : testing::Test {
  test::SweptVolume swept;
  glm::ivec3 size = swept.volume.size;

  // Rest points in part space, within the part.
  dvec3 anywhere(test::BentInstance& bent) const {
    return dvec3(size) * dvec3(bent.unit(), bent.unit(), bent.unit());
  }
  static glm::vec3 inObject(const Instance& instance, const dvec3& rest) {
    return glm::vec3(glm::dmat4x3(instance.asset->pack().parts()[0].to_object) * glm::dvec4(rest, 1));
  }
  ArcChain chainOf(const Instance& instance) const {
    ArcChain chain{};
    EXPECT_TRUE(
        makeArcs(instance.pose->knots(0), size, instance.pose->motion(0)->roll, kArcTolerance, chain));
    return chain;
  }
  // The arc that a height at rest belongs to.
  static const Arc& arcOf(const ArcChain& chain, double y) {
    int i = 0;
    while (i + 1 < chain.count && y > double{chain.joints[i + 1].y}) ++i;
    return chain.arcs[i];
  }
};

TEST_F(SweptPose, PointsGoToTheWorldAndBack) {
  swept.inPoses(8, [&](const std::string& name, test::BentInstance& bent) {
    const ArcChain chain = chainOf(bent.instance);
    const glm::dmat4 to_world(partToWorld(bent.instance, 0).value());
    int back = 0;
    for (int i = 0; i < 2000; ++i) {
      const dvec3 rest = anywhere(bent);
      const dvec3 truth(to_world * glm::dvec4(reference::swept(arcOf(chain, rest.y), size, rest), 1));
      const glm::vec3 object = inObject(bent.instance, rest),
                      world = toWorld(bent.instance, 0, object).value();
      ASSERT_LT(glm::distance(dvec3(world), truth), 0.002 * bent.voxel) << name;
      // Where coils overlap, the answer is another point; but it goes to the same place.
      const std::optional<glm::vec3> again = toRest(bent.instance, 0, world);
      ASSERT_TRUE(again) << name;
      ASSERT_LT(glm::distance(toWorld(bent.instance, 0, *again).value(), world), 0.01 * bent.voxel) << name;
      back += glm::distance(*again, object) < 0.01f / static_cast<float>(size.y);
    }
    EXPECT_GT(back, name == "helix" ? 1000 : 1900) << name;
  });
}

// Two coils cross: of the points that are there at rest, the one nearest to its center line answers.
TEST_F(SweptPose, WhereCoilsOverlapTheNearestCenterLineAnswers) {
  reference::SweepRig ring{"ring", {}, 0};
  constexpr double kTurn = 7.5, kRadius = 0.2, kLength = kTurn * kRadius;  // more than once round
  for (int i = 0; i <= 8; ++i) {
    const double at = i / 8.0, angle = kTurn * at;
    ring.knots.push_back(
        {static_cast<float>(at),
         glm::vec3(dvec3(kRadius * (1 - std::cos(angle)), kRadius * std::sin(angle), 0.06 * at)),
         glm::vec3(dvec3(kLength * std::sin(angle), kLength * std::cos(angle), 0.06))});
  }
  const test::SweptAsset asset(swept.pack, ring);
  test::BentInstance bent(*asset, swept.layers, ring.knots, glm::mat4(1), 1);
  const ArcChain chain = chainOf(bent.instance);
  const glm::dmat4 to_part = glm::inverse(glm::dmat4(partToWorld(bent.instance, 0).value()));
  const glm::dmat4 to_voxels = glm::inverse(glm::dmat4((*asset).pack().parts()[0].to_object));
  int several = 0;
  for (int i = 0; i < 4000; ++i) {
    const glm::vec3 world = toWorld(bent.instance, 0, inObject(bent.instance, anywhere(bent))).value();
    const dvec3 point(to_part * glm::dvec4(dvec3(world), 1));
    double nearest = 1e9, second = 1e9;
    for (int a = 0; a < chain.count; ++a) {
      const dvec3 rest = reference::unswept(chain.arcs[a], size, point);
      if (rest.y < double{chain.joints[a].y} || rest.y > double{chain.joints[a + 1].y}) continue;
      const double beside = std::hypot(rest.x - 0.5 * size.x, rest.z - 0.5 * size.z);
      second = std::min(second, std::max(nearest, beside));
      nearest = std::min(nearest, beside);
    }
    if (second > 30 || second - nearest < 0.05) continue;
    ++several;
    const dvec3 rest(to_voxels * glm::dvec4(dvec3(toRest(bent.instance, 0, world).value()), 1));
    ASSERT_NEAR(std::hypot(rest.x - 0.5 * size.x, rest.z - 0.5 * size.z), nearest, 0.02);
  }
  EXPECT_GT(several, 50);
}

TEST_F(SweptPose, FramesStandOnTheSpline) {
  swept.inPoses(8, [&](const std::string& name, test::BentInstance& bent) {
    const glm::dmat3 linear(glm::dmat4(partToWorld(bent.instance, 0).value()));
    const ArcChain chain = chainOf(bent.instance);
    for (int i = 0; i < 200; ++i) {
      dvec3 rest = anywhere(bent);
      rest.y = std::clamp(rest.y, 1.0, size.y - 1.0);
      const glm::mat4 frame = frameAt(bent.instance, 0, inObject(bent.instance, rest)).value();
      EXPECT_NEAR(glm::determinant(glm::mat3(frame)), 1, 1e-5f) << name;
      // Along the line, and across it, by finite differences.
      const Arc& arc = arcOf(chain, rest.y);
      const auto moved = [&](const dvec3& by) {
        return linear * (reference::swept(arc, size, rest + by) - reference::swept(arc, size, rest - by));
      };
      EXPECT_GT(glm::dot(glm::normalize(moved({0, 1e-3, 0})), dvec3(frame[1])), 1 - 1e-6) << name;
      EXPECT_GT(std::abs(glm::dot(glm::normalize(moved({1e-3, 0, 0})), dvec3(frame[0]))), 1 - 1e-6) << name;
    }
  });
}

TEST_F(SweptPose, BlendsTakeTheRollAlong) {
  const reference::SweepRig straight{"straight", test::straightStem(), 0};
  const test::SweptAsset asset(swept.pack, straight);
  Pose a = *Pose::create(*asset), b = *Pose::create(*asset);
  b.motion(0)->roll = 1.2f;
  ASSERT_TRUE(b.move(0, 4, {0.2f, -0.1f, 0}));
  ASSERT_TRUE(a.blend(b, 0.25f));
  EXPECT_FLOAT_EQ(a.motion(0)->roll, 0.3f);
  EXPECT_FLOAT_EQ(a.knots(0)[4].position.x, 0.05f);
}

TEST_F(SweptPose, ClampChangesWhatFoldsAndNothingElse) {
  const reference::SweepRig straight{"straight", test::straightStem(), 0};
  const test::SweptAsset asset(swept.pack, straight);
  for (const float bend : {0.03f, 0.1f, 3.0f, 30.0f}) {
    Pose pose = *Pose::create(*asset);
    ASSERT_TRUE(pose.setTangent(0, 2, {bend, 1 - bend, 0}));
    ASSERT_TRUE(pose.move(0, 4, {0.3f * bend, -0.2f * bend, 0.1f * bend}));
    const Result<void> checked = pose.check();
    const bool sound = bool(checked);
    EXPECT_EQ(sound, bend < 1) << bend << ": " << (sound ? "" : checked.error().detail);
    const std::vector<Knot> before(pose.knots(0).begin(), pose.knots(0).end());
    pose.clamp();
    EXPECT_TRUE(pose.check()) << bend;
    const bool same = std::memcmp(before.data(), pose.knots(0).data(), before.size() * sizeof(Knot)) == 0;
    EXPECT_EQ(same, sound) << bend;
    // It stays bent the same way, as far as it can be.
    if (!sound) {
      EXPECT_GT(pose.knots(0)[4].position.x, 0.01f) << bend;
    }
  }
}

TEST_F(SweptPose, SpringsSwingAndComeBack) {
  const reference::SweepRig straight{"straight", test::straightStem(), 0};
  const test::SweptAsset asset(swept.pack, straight);
  Spring spring = *Spring::create(*asset);
  Pose pose = *Pose::create(*asset);
  ASSERT_TRUE(spring.push(0, {3, 0, 1}));
  float farthest = 0;
  for (int frame = 0; frame < 1200; ++frame) {
    ASSERT_TRUE(spring.step(1 / 60.0f));
    pose.reset();
    ASSERT_TRUE(spring.addTo(pose));
    ASSERT_TRUE(pose.check()) << frame;
    farthest = std::max(farthest, std::abs(pose.knots(0)[4].position.x));
  }
  EXPECT_GT(farthest, 0.1f);
  EXPECT_LT(std::abs(pose.knots(0)[4].position.x), 1e-4f);

  // A body that walks into it moves it away, on the side where it stands.
  const Instance instance{&*asset, &pose};
  const glm::vec3 tip =
      toWorld(instance, 0, inObject(instance, {0.5 * size.x, 0.9 * size.y, 0.5 * size.z})).value();
  pose.reset();
  ASSERT_TRUE(spring.pushAway(instance, tip - glm::vec3(0.05f, 0, 0), 0.15f));
  ASSERT_TRUE(spring.addTo(pose));
  EXPECT_GT(pose.knots(0)[4].position.x, 0.01f);
}

}  // namespace
}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// Empty parts move what follows them and hold sockets; queries of voxels pass them by.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/runtime/distance.h"
#include "kelp/runtime/level.h"
#include "loaded.h"
#include "support/distance_pack.h"

namespace kelp::runtime {
namespace {

// A ball clump that follows an empty part of 400 voxels, far larger than itself.
RawPack hungOnNothing() {
  RawPack pack = test::distancePackOf(test::ballClump({24, 40, 24}, 8, 1), straight({0, 0.5f, 1}));
  RawPart joint;
  joint.name = "joint";
  joint.size = {100, 400, 100};
  joint.to_object = pack.parts[0].to_object;
  joint.knots = straight({0, 0.5f, 1});
  pack.parts[0].parent = 0;
  pack.parts[0].parent_at = 1;
  pack.parts.insert(pack.parts.begin(), joint);
  pack.sockets = {{"on joint", 0, 0.5f, {0, 0}, {1, 0, 0, 0}}};
  RawClip lift{"lift", 1, {}, {}};
  lift.tracks.push_back(
      {0, 0, Target::kPartTranslation, Interpolation::kLinear, {{0, {0, 2, 0, 0}, {}, {}}}});
  pack.clips = {lift};
  return pack;
}

struct HungScene {
  explicit HungScene(const RawPack& pack) : bytes(test::bytesOf(pack)), source(bytes) {
    AssetOptions options;
    options.distance_level = 0;
    asset = *Asset::open(source.source(), options);
    EXPECT_TRUE(asset->loadAll());
    pose.emplace(*Pose::create(*asset));
  }
  Instance instance() const { return {asset.get(), &*pose}; }
  std::vector<std::byte> bytes;
  MemorySource source;
  std::unique_ptr<Asset> asset;
  std::optional<Pose> pose;
};

TEST(EmptyParts, HaveNoLevels) {
  const HungScene scene(hungOnNothing());
  EXPECT_EQ(scene.asset->pack().minorVersion(), 1);
  for (const int wanted : {-1, 0, 3}) EXPECT_LT(scene.asset->residentLevel(0, wanted), 0);
  EXPECT_EQ(scene.asset->level(0, 0), nullptr);
  EXPECT_EQ(scene.asset->distances(0, 0), nullptr);
  EXPECT_GE(scene.asset->residentLevel(1, 0), 0);
}

TEST(EmptyParts, MoveWhatFollowsThem) {
  HungScene scene(hungOnNothing());
  RawPack alone = hungOnNothing();
  alone.parts.erase(alone.parts.begin());
  alone.parts[0].parent = -1;
  alone.parts[0].parent_at = Part::kNotOnSpline;
  alone.clips.clear();
  alone.sockets.clear();
  const HungScene plain(alone);
  const Box at_rest = bounds(plain.instance());
  const auto expectShifted = [&](const glm::vec3& by) {
    const Box box = bounds(scene.instance());
    EXPECT_LT(glm::distance(box.min, at_rest.min + by), 1e-5f);
    EXPECT_LT(glm::distance(box.max, at_rest.max + by), 1e-5f);
    const Ray down{at_rest.max + by + glm::vec3(-0.3f, 1, -0.3f), {0, -1, 0}, 10};
    const Ray plain_down{at_rest.max + glm::vec3(-0.3f, 1, -0.3f), {0, -1, 0}, 10};
    const auto hit = raycast(scene.instance(), down), wanted = raycast(plain.instance(), plain_down);
    ASSERT_EQ(hit.has_value(), wanted.has_value());
    if (hit) {
      EXPECT_NEAR(hit->t, wanted->t, 1e-4f);
      EXPECT_EQ(hit->part, 1);
    }
    const auto far = distance(scene.instance(), down.origin),
               near = distance(plain.instance(), plain_down.origin);
    ASSERT_TRUE(far && near);
    EXPECT_NEAR(far->bound, near->bound, 1e-4f);
    EXPECT_EQ(far->part, 1);
  };
  expectShifted({0, 0, 0});
  const glm::vec3 socket((*socketToWorld(scene.instance(), 0))[3]);
  ASSERT_TRUE(addClip(*scene.asset, 0, 0.5f, 1, *scene.pose));
  expectShifted({0, 2, 0});
  EXPECT_LT(glm::distance(glm::vec3((*socketToWorld(scene.instance(), 0))[3]), socket + glm::vec3(0, 2, 0)),
            1e-5f);
  // The clump hangs at the end of the empty part's spline.
  scene.pose->reset();
  ASSERT_TRUE(scene.pose->move(0, 2, {0.25f, 0, 0}));
  const glm::vec3 by((*partToWorld(scene.instance(), 1))[3] - (*partToWorld(plain.instance(), 0))[3]);
  EXPECT_GT(glm::length(by), 1.0f);
}

}  // namespace
}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// raycast() on whole instances against the double-precision ground truth.
#include <gtest/gtest.h>

#include <random>

#include "kelp/runtime/instance.h"
#include "reference/ground_truth.h"
#include "support/edit_knots.h"
#include "support/test_pack.h"
#include "support/voxel_points.h"

namespace kelp::runtime {
namespace {

TEST(Raycast, AgreesWithTheGroundTruthFromAfar) {
  const fields::Occupancy volume = test::ballClump({60, 80, 50}, 20, 2);
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(volume));
  MemorySource source(bytes);
  auto opened = Asset::open(source.source());
  ASSERT_TRUE(opened);
  const Asset& asset = **opened;
  ASSERT_TRUE((*opened)->loadAll());
  Pose pose = *Pose::create(asset);
  const reference::Volume truth{volume.size, volume.solid, 1.0, volume.size};
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  int hits = 0;
  for (const auto& figure : test::kFigure6) {
    const std::vector<Knot> knots = test::figureKnots(figure);
    ASSERT_TRUE(pose.setKnots(0, knots));
    Instance instance{&asset, &pose};
    instance.to_world = glm::mat4(glm::vec4(0, 0, 2, 0), glm::vec4(0, 3, 0, 0), glm::vec4(-2, 0.5f, 0, 0),
                                  glm::vec4(30, -20, 10, 1));
    const glm::dmat4 to_part = glm::inverse(glm::dmat4(partToWorld(instance, 0).value()));
    for (int i = 0; i < 3000; ++i) {
      const glm::vec3 target =
          test::voxelToWorld(instance, 0, {60 * unit(random), 80 * unit(random), 50 * unit(random)});
      Ray ray;
      ray.direction = 0.1f + 5.0f * (glm::vec3(unit(random), unit(random), unit(random)) - 0.5f);
      ray.origin = target - 30.0f * ray.direction;
      const auto hit = raycast(instance, ray);
      const glm::dvec3 o(to_part * glm::dvec4(ray.origin, 1));
      const glm::dvec3 d(to_part * glm::dvec4(ray.direction, 0));
      const double length = glm::length(d);
      const auto certain = reference::firstTouch(truth, knots, o, d / length, 0, 1e6, 0.01);
      const auto possible = reference::firstTouch(truth, knots, o, d / length, 0, 1e6, -0.01);
      if (certain) {
        ASSERT_TRUE(hit) << figure.name;
        EXPECT_LE(double{hit->t} * length, certain->s + 0.02) << figure.name;
      }
      if (!hit) continue;
      ++hits;
      ASSERT_TRUE(possible) << figure.name;
      EXPECT_GE(double{hit->t} * length, possible->s - 0.02) << figure.name;
      EXPECT_TRUE(volume.solid[volume.index(hit->voxel)]);
      EXPECT_NEAR(glm::length(hit->normal), 1.0f, 1e-4f);
      EXPECT_EQ(hit->part, 0);
      EXPECT_EQ(hit->level, 0);
      // A shorter ray does not reach it.
      ray.t_max = hit->t * 0.999f;
      EXPECT_FALSE(raycast(instance, ray));
    }
  }
  EXPECT_GT(hits, 3000);
}

// As it is drawn: an instance with a part that cannot be drawn is not there.
TEST(Raycast, MissesAllOfAnInstanceWithABadPart) {
  RawPack pack = test::packOf(test::ballClump({20, 20, 20}, 5, 2));
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "second";
  pack.parts[1].to_object[3].x += 3;
  const std::vector<std::byte> bytes = test::bytesOf(pack);
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  ASSERT_TRUE((*asset)->loadAll());
  Pose pose = *Pose::create(**asset);
  const Instance instance{asset->get(), &pose};
  const Ray down{{0, 10, 0}, {0, -1, 0}};
  ASSERT_TRUE(raycast(instance, down));
  ASSERT_TRUE(pose.move(1, 1, {0, -2, 0}));
  EXPECT_FALSE(raycast(instance, down));
}

TEST(Raycast, RefusesNonsense) {
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(test::ballClump({20, 20, 20}, 5, 2)));
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  Instance instance{asset->get()};
  const Ray down{{0, 10, 0}, {0, -1, 0}};
  EXPECT_FALSE(raycast(instance, down)) << "nothing resident";
  ASSERT_TRUE((*asset)->loadAll());
  EXPECT_TRUE(raycast(instance, down));
  EXPECT_FALSE(raycast(Instance{}, down));
  EXPECT_FALSE(raycast(instance, {{0, 10, 0}, {0, 0, 0}}));
  EXPECT_FALSE(raycast(instance, {{0, NAN, 0}, {0, -1, 0}}));
  EXPECT_FALSE(raycast(instance, {{0, 10, 0}, {0, -INFINITY, 0}}));
  Pose pose = *Pose::create(**asset);
  test::edit(pose, 0, 20)[1].tangent.y = -500;
  instance.pose = &pose;
  EXPECT_FALSE(raycast(instance, down)) << "not monotone";
  instance.pose = nullptr;
  instance.to_world = glm::mat4(0);
  EXPECT_FALSE(raycast(instance, down)) << "singular";
}

}  // namespace
}  // namespace kelp::runtime

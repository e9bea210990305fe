// SPDX-License-Identifier: MIT
// End knots moved along y: the volume follows the paper's map, y = Y (Sy(t) - Sy(0)) / (Sy(1) - Sy(0)), here
// in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/runtime/instance.h"
#include "loaded.h"
#include "support/edit_knots.h"
#include "support/voxel_knots.h"
#include "support/voxel_points.h"

namespace kelp::runtime {
namespace {

// S at parameter t of the segment from k0 to k1, in the Hermite basis.
glm::dvec3 splineAt(const Knot& k0, const Knot& k1, double t) {
  const double share = static_cast<double>(k1.at) - static_cast<double>(k0.at), u = 1 - t;
  return (1 + 2 * t) * u * u * glm::dvec3(k0.position) + t * u * u * share * glm::dvec3(k0.tangent) +
         t * t * (3 - 2 * t) * glm::dvec3(k1.position) - t * t * u * share * glm::dvec3(k1.tangent);
}

// Where a rest point of a volume of height Y goes, in part space: the spline point at its height, by
// bisection.
glm::dvec3 mapped(std::span<const Knot> knots, double height, const glm::dvec3& rest) {
  const double low = knots.front().position.y, high = knots.back().position.y,
               y = low + rest.y / height * (high - low);
  std::size_t i = 0;
  while (i + 2 < knots.size() && static_cast<double>(knots[i + 1].position.y) < y) ++i;
  double from = 0, to = 1;
  for (int step = 0; step < 60; ++step)
    (splineAt(knots[i], knots[i + 1], (from + to) / 2).y < y ? from : to) = (from + to) / 2;
  const glm::dvec3 s = splineAt(knots[i], knots[i + 1], from);
  return {rest.x + s.x, y, rest.z + s.z};
}

TEST(Stretch, TheVolumeFollowsThePapersMap) {
  Loaded loaded(reed({0, 0.4f, 1}));
  Pose pose = *Pose::create(*loaded.asset);
  Instance instance{loaded.asset.get(), &pose};
  instance.to_world =
      glm::rotate(glm::translate(glm::mat4(1), glm::vec3(3, -1, 2)), 0.7f, glm::vec3(0, 0.6f, 0.8f));
  std::mt19937 random(13);
  std::uniform_real_distribution<float> unit(0, 1), d(-1, 1);
  int stretched = 0, squashed = 0;
  for (int n = 0; n < 300; ++n) {
    pose.reset();
    const float low = 12 * d(random), high = 40 + 30 * d(random);
    for (Knot& knot : test::edit(pose, 0, 40)) {
      knot.position = {10 * d(random), low + knot.at * (high - low), 10 * d(random)};
      knot.tangent = {30 * d(random), (high - low) * (1 + 0.5f * d(random)), 30 * d(random)};
    }
    if (high - low < 5 || !pose.check()) continue;
    ++(high - low > 40 ? stretched : squashed);
    const glm::dmat4 to_world(partToWorld(instance, 0).value());
    const Box box = bounds(instance);
    for (int i = 0; i < 20; ++i) {
      const glm::vec3 rest(24 * unit(random), 40 * unit(random), 24 * unit(random));
      const glm::dvec3 expected(
          to_world * glm::dvec4(mapped(test::inVoxels(pose.knots(0), 40), 40, glm::dvec3(rest)), 1));
      const glm::vec3 world = test::voxelToWorld(instance, 0, rest);
      EXPECT_LT(glm::distance(glm::dvec3(world), expected), 2e-5);  // of a meter of 40 voxels
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(expected[axis], static_cast<double>(box.min[axis]) - 1e-6);
        EXPECT_LE(expected[axis], static_cast<double>(box.max[axis]) + 1e-6);
      }
      const auto back = toRest(instance, 0, world);
      if (rest.y > 0.1f && rest.y < 39.9f) {
        ASSERT_TRUE(back);
        EXPECT_LT(glm::distance(test::restToVoxel(instance, 0, *back), rest), 2e-2f);
      }
    }
  }
  EXPECT_GT(stretched, 50);
  EXPECT_GT(squashed, 50);
}

// A straight rig of twice the height is the volume of twice the height, exactly.
TEST(Stretch, StraightRigsScale) {
  Loaded loaded(reed({0, 0.5f, 1}));
  Pose pose = *Pose::create(*loaded.asset);
  for (Knot& knot : test::edit(pose, 0, 40)) {
    knot.position.y *= 2;
    knot.tangent.y *= 2;
  }
  const Instance instance{loaded.asset.get(), &pose};
  for (const float y : {0.0f, 7.0f, 20.0f, 33.0f, 40.0f}) {
    EXPECT_NEAR(test::voxelToWorld(instance, 0, {12, y, 12}).y, 2 * y / 40, 1e-6f);
  }
}

}  // namespace
}  // namespace kelp::runtime

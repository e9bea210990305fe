// SPDX-License-Identifier: MIT
// distance() never exceeds the distance to the bent solid, and is not much less.
#include "kelp/runtime/distance.h"

#include <gtest/gtest.h>

#include <random>

#include "bent_truth.h"
#include "support/all_tests.h"
#include "support/distance_pack.h"

namespace kelp::runtime {
namespace {

std::unique_ptr<Asset> loadDistances(const MemorySource& source, int finest = 0) {
  Options options;
  options.distance_level = finest;
  auto asset = Asset::open(source.source(), options).value();
  EXPECT_TRUE(asset->loadAll());
  return asset;
}

// bound / truth near three distances.
struct Quality {
  std::vector<double> ratios[3];
  void add(double truth, double bound) {
    static constexpr double kNear[3] = {2, 8, 32};
    for (int i = 0; i < 3; ++i)
      if (truth > 0.75 * kNear[i] && truth < 1.33 * kNear[i]) ratios[i].push_back(bound / truth);
  }
  double median(int i) {
    std::vector<double>& r = ratios[i];
    if (r.empty()) return 0;
    std::nth_element(r.begin(), r.begin() + static_cast<std::ptrdiff_t>(r.size() / 2), r.end());
    return r[r.size() / 2];
  }
};

// Compares distance() with the truth at points of all kinds. Returns how many are overestimated.
int tryPoints(const Instance& instance, const test::BentTruth& truth, int count, unsigned seed,
              Quality& quality) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const glm::dmat4 to_world(partToWorld(instance, 0));
  const glm::dmat4 to_part = glm::inverse(to_world);
  const double voxel = glm::length(glm::dvec3(to_world[0]));  // of the tests that ask for quality
  const Part& part = instance.asset->pack().parts()[0];
  const Box box = deformedBounds(instance.pose ? instance.pose->knots(0) : part.knots, part.size);
  int over = 0;
  for (int i = 0; i < count; ++i) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = glm::mix(double{box.min[axis]} - 20, double{box.max[axis]} + 20, unit(random));
    if (i % 4 != 0) {  // at some distance from the solid
      const glm::dvec3 direction(normal(random), normal(random), normal(random));
      p = truth.nearest(p) + std::exp(glm::mix(-3.0, 4.0, unit(random))) * glm::normalize(direction);
    }
    const glm::vec3 world(to_world * glm::dvec4(p, 1));
    p = glm::dvec3(to_part * glm::dvec4(glm::dvec3(world), 1));
    const glm::dvec3 nearest = truth.nearest(p);
    const double exact = glm::length(glm::dmat3(to_world) * (nearest - p));
    const Result<Distance> found = distance(instance, world);
    EXPECT_TRUE(found);
    if (!found) return count;
    EXPECT_NEAR(glm::length(found->away), 1, 1e-5);
    if (!(double{found->bound} <= exact)) {
      if (++over < 4)
        ADD_FAILURE() << found->bound / voxel << " is more than " << exact / voxel << " voxels at " << p.x
                      << " " << p.y << " " << p.z << " level " << found->level;
    }
    if (found->bound < 0 && exact > 1e-6 * voxel) ++over;
    if (exact == 0 && found->level == 0 && instance.asset->distances(0, 0)) {
      EXPECT_LT(found->bound, 0);
      for (int k = 0; k < 4 && double{-found->bound} > 0.002 * voxel; ++k) {
        const glm::dvec3 direction(normal(random), normal(random), normal(random));
        const glm::dvec3 beside =
            glm::dvec3(world) - 0.9999 * double{found->bound} * glm::normalize(direction);
        if (!truth.inside(glm::dvec3(to_part * glm::dvec4(beside, 1)))) ++over;
      }
    }
    quality.add(exact / voxel, double{found->bound} / voxel);
  }
  return over;
}

glm::mat4 turned(float angle, const glm::vec3& scale, const glm::vec3& at) {
  glm::mat4 m = glm::mat4_cast(glm::angleAxis(angle, glm::normalize(glm::vec3(1, 2, -0.5f))));
  for (int i = 0; i < 3; ++i) m[i] *= scale[i];
  m[3] = glm::vec4(at, 1);
  return m;
}

TEST(DistanceQuery, NeverExceedsTheTruthInThePosesOfFigure6) {
  const fields::Occupancy volume = test::ballClump({60, 80, 50}, 20, 2);
  const std::vector<std::byte> bytes = test::bytesOf(test::distancePackOf(volume));
  MemorySource source(bytes);
  const auto asset = loadDistances(source);
  const test::Layers layers(volume);
  Pose pose = *Pose::create(*asset);
  for (const test::FigurePose& figure : test::kFigure6) {
    const std::vector<Knot> knots = test::figureKnots(figure);
    ASSERT_TRUE(pose.setKnots(0, knots));
    const test::BentTruth truth(layers, knots);
    const Instance instance{asset.get(), &pose, turned(1, glm::vec3(2, 2, -2), {100, -20, 3})};
    Quality quality;
    EXPECT_EQ(tryPoints(instance, truth, test::shareOf(20'000), 1, quality), 0) << figure.name;
    const bool rest = &figure == &test::kFigure6[0];
    std::printf("%-22s %.2f %.2f %.2f  (%zu %zu %zu)\n", figure.name, quality.median(0), quality.median(1),
                quality.median(2), quality.ratios[0].size(), quality.ratios[1].size(),
                quality.ratios[2].size());
    (void)rest;
  }
}

}  // namespace
}  // namespace kelp::runtime

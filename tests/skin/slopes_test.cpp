// SPDX-License-Identifier: MIT
// How weights go on below a surface: against points that are posed here.
#include <gtest/gtest.h>

#include <vector>

#include "skin_shapes.h"
#include "slopes.h"

namespace kelp::bake {
namespace {

using test::SkinnedShape;

// A sheet between two joints, the second of which is elsewhere at a moment. A point of the surface, and one a
// little under it whose weights have changed by the slopes, go where these weights take them.
TEST(SkinSlopes, PutBackWhatTheSurfaceTurnsOver) {
  SkinnedShape shape;
  constexpr int kSide = 9;
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y) {
      const float upper = static_cast<float>(y) / (kSide - 1);
      shape.addVertex({0, 8.0 * y, 8.0 * z}, {{0, 1 - upper}, {1, upper}});
    }
  for (std::uint32_t z = 0; z + 1 < kSide; ++z)
    for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
      const std::uint32_t at = y + kSide * z;
      shape.addTriangle(at, at + 1, at + kSide);
      shape.addTriangle(at + 1, at + kSide + 1, at + kSide);
    }
  shape.skin().first_influence.push_back(static_cast<std::uint32_t>(shape.skin().influences.size()));
  shape.frame.node_to_voxel = glm::dmat4(1);
  SkinSamples samples = sampleSkin(shape.soup(), shape.skin(), shape.frame, 2, glm::dvec2(1.0 / 3), 100000);
  const auto moved = [](double turn, const glm::dvec3& by) {
    const glm::dmat4x3 motion(glm::translate(glm::dmat4(1), by) *
                              glm::rotate(glm::dmat4(1), turn, glm::dvec3(0, 0, 1)));
    return std::vector<std::vector<SkinMoment>>{{{{glm::dmat4x3(1), motion}, {}}}};
  };
  const auto find = [&](const std::vector<std::vector<SkinMoment>>& moments) {
    return slopesUnder(shape.soup(), shape.skin(), shape.frame, samples, moments, 2);
  };
  const auto at = [&](std::size_t s, const glm::dvec3& off, double more, const JointMotions& motions) {
    const double upper = (samples.positions[s].y + off.y) / (8.0 * (kSide - 1)) + more;
    const glm::dvec4 point(samples.positions[s] + off, 1);
    return (1 - upper) * (motions[0] * point) + upper * (motions[1] * point);
  };
  const auto isOver = [&](std::size_t s, const std::vector<double>& slopes, const JointMotions& motions) {
    constexpr double kStep = 1e-5;
    EXPECT_EQ(samples.weights(s).size(), 2u);
    EXPECT_NEAR(slopes[2 * s], -slopes[2 * s + 1], 1e-12);
    const glm::dvec3 here = at(s, glm::dvec3(0), 0, motions), &normal = samples.normals[s];
    const glm::dvec3 y = at(s, {0, kStep, 0}, 0, motions) - here, z = at(s, {0, 0, kStep}, 0, motions) - here;
    const glm::dvec3 out = at(s, kStep * normal, kStep * slopes[2 * s + 1], motions) - here;
    return glm::dot(glm::cross(y, z), out) * normal.x <= 0;
  };
  // The upper end goes down past the lower one, and aside: the sheet hangs over.
  const auto over = moved(0.5, {-60, -100, 0});
  const std::vector<double> none(samples.weighted.size(), 0), found = find(over);
  int turned = 0;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    turned += isOver(s, none, over[0][0].joints);
    EXPECT_FALSE(isOver(s, found, over[0][0].joints)) << s;
  }
  EXPECT_GT(turned, static_cast<int>(samples.size()) / 2);
  // Nothing is turned over; or nothing helps: it moves within its own plane.
  EXPECT_EQ(find(moved(0.5, {0, 10, 0})), none);
  EXPECT_EQ(find(moved(0, {0, -100, 0})), none);
}

}  // namespace
}  // namespace kelp::bake

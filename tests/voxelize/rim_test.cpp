// SPDX-License-Identifier: MIT
// The rims of holes in surfaces whose slope is known.
#include "rim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace kelp::bake {
namespace {

struct Hole {
  std::vector<glm::dvec3> corners, normals;
};

// A round hole of some radius at the top of a surface that is the same all around. `slope`: how steeply it
// rises towards the hole, as an angle. `wave`: the rim goes up and down three times by as much.
Hole roundHole(double radius, double slope, int corners = 2000, double wave = 0) {
  Hole hole;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, c = std::cos(angle), s = std::sin(angle);
    hole.corners.emplace_back(radius * c, radius * s, wave * std::sin(3 * angle));
    hole.normals.emplace_back(std::sin(slope) * c, std::sin(slope) * s, std::cos(slope));
  }
  return hole;
}

// Over a sphere's cap of the angle a the surface rises at a; a plate has 0, a tube a quarter turn, a funnel
// more.
TEST(Rim, TellsHowTheSurfaceAroundGoesOn) {
  for (const double slope : {0.0, 0.3, 1.0, std::numbers::pi / 2, 2.0, -0.5}) {
    const Hole hole = roundHole(20, slope);
    const Rim rim = walkRim(hole.corners, hole.normals);
    ASSERT_EQ(rim.points.size(), 64u);
    EXPECT_NEAR(rim.rise, std::sin(slope), 1e-3) << slope;
    EXPECT_NEAR(rim.inward, std::cos(slope), 1e-3) << slope;
    EXPECT_NEAR(rim.unevenness, 0, 1e-9);
  }
}

// A point is the mean of the rim a step to both sides: of a circle, one on a circle that is smaller by sin(a)
// / a.
TEST(Rim, WalksInEvenSteps) {
  for (const double radius : {3.0, 5.0, 8.0, 40.0}) {
    const Hole hole = roundHole(radius, 0.4);
    const Rim rim = walkRim(hole.corners, hole.normals);
    const double length = 2 * std::numbers::pi * radius, steps = std::min(std::round(length), 64.0);
    ASSERT_EQ(static_cast<double>(rim.points.size()), steps);
    EXPECT_NEAR(rim.step, length / steps, 1e-3);
    const double reach = 2 * std::numbers::pi / steps, expected = radius * std::sin(reach) / reach;
    for (std::size_t i = 0; i < rim.points.size(); ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / steps;
      EXPECT_LT(glm::distance(rim.points[i], expected * glm::dvec3(std::cos(angle), std::sin(angle), 0)),
                1e-3 * radius);
      // A step back on the surface: outward and down.
      const glm::dvec3 back = rim.beyond[i] - rim.points[i];
      EXPECT_LT(glm::distance(back, rim.step * glm::dvec3(std::cos(0.4) * std::cos(angle),
                                                          std::cos(0.4) * std::sin(angle), -std::sin(0.4))),
                1e-2 * rim.step);
    }
  }
}

// A wave of the height a has 2 a / pi in the mean, less what the averaging takes: sin(3 r) / (3 r) over a
// reach r.
TEST(Rim, MeasuresHowFarItIsFromAPlane) {
  const double radius = 20, wave = 2;
  const Hole hole = roundHole(radius, 0.4, 4000, wave);
  const Rim rim = walkRim(hole.corners, hole.normals);
  const double reach = 3 * 2 * std::numbers::pi / 64,
               expected = 2 / std::numbers::pi * wave * std::sin(reach) / reach / radius;
  EXPECT_NEAR(rim.unevenness, expected, 0.03 * expected);
}

// Jags that are finer than a step, and the number and length of the corners' normals, change next to nothing.
TEST(Rim, DoesNotSeeWhatIsFinerThanAStep) {
  Hole smooth = roundHole(20, 0.4, 3000), jagged = smooth;
  for (std::size_t i = 0; i < jagged.corners.size(); ++i) {
    jagged.corners[i] += (i % 2 ? 0.02 : -0.02) * jagged.normals[i];
    jagged.normals[i] *= i % 3 + 0.5;
  }
  const Rim a = walkRim(smooth.corners, smooth.normals), b = walkRim(jagged.corners, jagged.normals);
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_NEAR(a.rise, b.rise, 0.01);
  EXPECT_NEAR(a.inward, b.inward, 0.01);
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_LT(glm::distance(a.points[i], b.points[i]), 0.2);
}

TEST(Rim, AnUnevenlyDividedRimIsTheSameRim) {
  const Hole even = roundHole(20, 0.4, 4000);
  Hole uneven;
  for (std::size_t i = 0; i < even.corners.size(); ++i) {
    if (i > 2000 && i % 10) continue;
    uneven.corners.push_back(even.corners[i]);
    uneven.normals.push_back(even.normals[i]);
  }
  const Rim a = walkRim(even.corners, even.normals), b = walkRim(uneven.corners, uneven.normals);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_LT(glm::distance(a.points[i], b.points[i]), 0.02);
  EXPECT_NEAR(a.rise, b.rise, 1e-3);
}

TEST(Rim, HolesWithoutAnInsideHaveNone) {
  EXPECT_TRUE(walkRim(roundHole(2, 0.4).corners, roundHole(2, 0.4).normals).points.empty());  // 12.6 voxels^2
  EXPECT_FALSE(walkRim(roundHole(2.5, 0.4).corners, roundHole(2.5, 0.4).normals).points.empty());  // 19.6
  const Hole point{std::vector<glm::dvec3>(3, glm::dvec3(1)),
                   std::vector<glm::dvec3>(3, glm::dvec3(0, 0, 1))};
  EXPECT_TRUE(walkRim(point.corners, point.normals).points.empty());
  // A figure of eight encloses nothing on the whole.
  Hole eight = roundHole(20, 0.4);
  for (std::size_t i = 0; i < eight.corners.size(); ++i) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(eight.corners.size());
    eight.corners[i] = {20 * std::sin(2 * angle), 20 * std::cos(angle), 0};
  }
  EXPECT_TRUE(walkRim(eight.corners, eight.normals).points.empty());
}

}  // namespace
}  // namespace kelp::bake

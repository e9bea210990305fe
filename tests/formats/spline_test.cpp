// SPDX-License-Identifier: MIT
#include "kelp/formats/spline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "support/spline_truth.h"
#include "support/straight_knots.h"
#include "support/voxel_knots.h"

namespace kelp {
namespace {

using test::randomKnot;
using test::SplineTruth;

TEST(Spline, EvaluatesLikeTheHermiteBasisInDoublePrecision) {
  std::mt19937 random(1);
  for (int n = 0; n < 2000; ++n) {
    const Knot k0 = randomKnot(random, 0.25f, 500.0f);
    const Knot k1 = randomKnot(random, 0.75f, 500.0f);
    const Segment segment = makeSegment(k0, k1, 1);
    const SplineTruth reference(k0, k1);
    for (int step = 0; step <= 16; ++step) {
      const float t = static_cast<float>(step) / 16.0f;
      for (int i = 0; i < 3; ++i) {
        ASSERT_NEAR(evaluate(segment, t)[i], reference.value(i, t), 2e-3);
        ASSERT_NEAR(derivative(segment, t)[i], reference.slope(i, t), 8e-3);
      }
    }
  }
}

TEST(Spline, PaperPoseRisesAsThePaperSays) {
  // Tangents (3,0,1) and (3,0,2) of Figure 6: Sy = Y (3 t^2 - 2 t^3), Sx = 3 (t - 3 t^2 + 2 t^3).
  const float height = 256.0f;
  const Knot k0{0.0f, {0, 0, 0}, {3, 0, 1}};
  const Knot k1{1.0f, {0, height, 0}, {3, 0, 2}};
  const Segment segment = makeSegment(k0, k1, 1);
  for (int step = 0; step <= 64; ++step) {
    const float t = static_cast<float>(step) / 64.0f;
    const glm::vec3 s = evaluate(segment, t);
    EXPECT_NEAR(s.y, height * (3 * t * t - 2 * t * t * t), 1e-4f * height);
    EXPECT_NEAR(s.x, 3 * (t - 3 * t * t + 2 * t * t * t), 1e-5f);
    EXPECT_NEAR(s.z, 1 * (t - 2 * t * t + t * t * t) + 2 * (t * t * t - t * t), 1e-5f);
  }
  EXPECT_EQ(derivative(segment, 0.0f), glm::vec3(3, 0, 1));
  EXPECT_EQ(derivative(segment, 1.0f), glm::vec3(3, 0, 2));
  EXPECT_TRUE(isMonotone(segment));
  EXPECT_TRUE(checkKnots(std::array{k0, k1}));
}

TEST(Spline, TangentsBelongToTheWholeAxis) {
  // A straight line keeps its constant slope however many knots lie on it, and wherever.
  const glm::vec3 tangent(0, 96, 0);
  for (const float split : {0.1f, 0.5f, 0.9f}) {
    const Segment lower = makeSegment({0, {0, 0, 0}, tangent}, {split, split * tangent, tangent}, 1);
    const Segment upper = makeSegment({split, split * tangent, tangent}, {1, tangent, tangent}, 1);
    for (const float t : {0.0f, 0.3f, 1.0f}) {
      EXPECT_NEAR(evaluate(lower, t).y, 96 * split * t, 1e-4f);
      EXPECT_NEAR(evaluate(upper, t).y, 96 * (split + (1 - split) * t), 1e-4f);
    }
  }
}

TEST(Spline, StraightKnotsAreTheIdentity) {
  const std::vector<Knot> knots = test::straightKnots();
  ASSERT_TRUE(checkKnots(knots));
  const Segment segment = makeSegment(knots[0], knots[1], 70);
  for (const float t : {0.0f, 0.25f, 0.5f, 1.0f}) EXPECT_EQ(evaluate(segment, t), glm::vec3(0, 70 * t, 0));
}

// The largest fall of Sy below an earlier height, by dense sampling in double precision.
double sampledFall(const SplineTruth& r) {
  double highest = r.value(1, 0), fall = 0;
  for (int step = 1; step <= 4000; ++step) {
    const double y = r.value(1, step / 4000.0);
    fall = std::max(fall, highest - y);
    highest = std::max(highest, y);
  }
  return fall;
}

TEST(Spline, IsMonotoneAgreesWithDenseSampling) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> tangent(-1.0f, 6.0f);
  int yes = 0, no = 0;
  for (int n = 0; n < 3000; ++n) {
    const float rise = 100.0f;
    const Knot k0{0, {0, 10, 0}, {5, rise * tangent(random), 0}};
    const Knot k1{1, {0, 10 + rise, 0}, {-5, rise * tangent(random), 1}};
    const double fall = sampledFall(SplineTruth(k0, k1)) / rise;
    if (fall > 2e-6 && fall < 2e-5) continue;  // too near to the tolerance for samples to tell
    const bool expected = fall <= 1e-5;
    ASSERT_EQ(isMonotone(makeSegment(k0, k1, 1)), expected)
        << k0.tangent.y << " " << k1.tangent.y << " fall " << fall;
    ++(expected ? yes : no);
  }
  EXPECT_GT(yes, 300);
  EXPECT_GT(no, 300);
}

TEST(Spline, IsMonotoneHoldsAtItsLimits) {
  const auto segment = [](float rise, float m0, float m1) {
    return makeSegment({0, {0, 0, 0}, {0, m0, 0}}, {1, {0, rise, 0}, {0, m1, 0}}, 1);
  };
  // Fritsch and Carlson 1980: both tangents within 3 times the rise are always monotone; equal ones not
  // beyond.
  EXPECT_TRUE(isMonotone(segment(64, 3 * 64, 3 * 64)));
  EXPECT_FALSE(isMonotone(segment(64, 3.1f * 64, 3.1f * 64)));
  EXPECT_TRUE(isMonotone(segment(64, 0, 3 * 64)));
  EXPECT_FALSE(isMonotone(segment(64, 0, 3.1f * 64)));
  EXPECT_TRUE(isMonotone(segment(64, 0, 0)));
  // The furthest point of their ellipse: 4 times the rise, with the other tangent equal to the rise.
  EXPECT_TRUE(isMonotone(segment(64, 4 * 64, 1 * 64)));
  EXPECT_FALSE(isMonotone(segment(64, 4.1f * 64, 1 * 64)));
  EXPECT_FALSE(isMonotone(segment(64, -0.1f * 64, 64)));
  EXPECT_FALSE(isMonotone(segment(0, 0, 0)));   // never rises
  EXPECT_FALSE(isMonotone(segment(-1, 0, 0)));  // falls
  EXPECT_FALSE(isMonotone(segment(1, std::numeric_limits<float>::quiet_NaN(), 0)));
  EXPECT_FALSE(isMonotone(segment(1, std::numeric_limits<float>::infinity(), 0)));
}

TEST(Spline, IsMonotoneToleratesOnlyRounding) {
  // A dip of known depth: Sy' = k (t - 1/2)^2 - e falls by (4/3) e sqrt(e / k) around one half.
  const double k = 12.0, rise = 1.0;
  for (const double depth : {0.5e-5, 2e-5}) {
    const double e = std::pow(0.75 * depth * std::sqrt(k), 2.0 / 3.0);
    Segment s;
    s.m0.y = s.m1.y = static_cast<float>(k / 4 - e);
    s.p1.y = static_cast<float>(k / 12 - e);
    EXPECT_EQ(isMonotone(s), depth <= 1e-5 * (rise - e)) << depth;
  }
}

TEST(Spline, CheckKnotsNamesTheKnotAndTheReason) {
  const auto make = [] {
    std::vector<Knot> knots(4);
    for (int i = 0; i < 4; ++i) {
      const float at = static_cast<float>(i) / 3.0f;
      knots[i] = {i == 3 ? 1.0f : at, {0, at * 90, 0}, {0, 90, 0}};
    }
    return knots;
  };
  EXPECT_TRUE(checkKnots(make()));

  const auto expect = [](const std::vector<Knot>& knots, ErrorCode code, std::uint64_t knot) {
    const Result<void> result = checkKnots(knots);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, code) << result.error().detail;
    EXPECT_EQ(result.error().offset, knot);
  };
  auto knots = make();
  knots[2].at = knots[1].at;
  expect(knots, ErrorCode::kMisuse, 2);
  knots = make();
  knots[0].at = 0.1f;
  expect(knots, ErrorCode::kMisuse, 0);
  knots = make();
  knots[3].at = 0.99f;
  expect(knots, ErrorCode::kMisuse, 3);
  knots = make();
  knots[1].tangent.z = std::numeric_limits<float>::infinity();
  expect(knots, ErrorCode::kMisuse, 1);
  knots = make();
  knots[1].at = std::numeric_limits<float>::quiet_NaN();
  expect(knots, ErrorCode::kMisuse, 1);
  knots = make();
  knots[2].position.y = 10;  // below knot 1
  expect(knots, ErrorCode::kNotMonotone, 1);
  knots = make();
  knots[1].position.x = 3e38f;
  knots[2].position.x = -3e38f;
  expect(knots, ErrorCode::kMisuse, 0);
  for (const float far : {1e33f, 1e35f}) {  // heights: voxels of the tallest part must be finite as well
    knots = make();
    knots[1].position.x = far;
    EXPECT_EQ(static_cast<bool>(checkKnots(knots)), std::isfinite(6 * 32768 * far)) << far;
  }
  knots = make();
  expect({knots[0]}, ErrorCode::kMisuse, 0);
  expect({}, ErrorCode::kMisuse, 0);
  expect(std::vector<Knot>(kMaxKnots + 1), ErrorCode::kMisuse, 0);
}

TEST(Spline, BoundsContainEveryDeformedVoxelAndFitTightly) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> side(-300.0f, 300.0f), unit(0.0f, 1.0f);
  const glm::ivec3 size(40, 120, 25);
  for (int n = 0; n < 300; ++n) {
    std::vector<Knot> knots;
    for (const float at : {0.0f, 0.4f, 1.0f}) {
      knots.push_back(
          {at, {side(random), at * 120, side(random)}, {side(random), 240 * unit(random), side(random)}});
    }
    if (!checkKnots(knots)) continue;
    const Box box = deformedBounds(test::inHeights(knots, 120), size);
    Box sampled;
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      const SplineTruth reference(knots[k], knots[k + 1]);
      const Segment segment = makeSegment(knots[k], knots[k + 1], 1);  // in voxels
      for (int step = 0; step <= 500; ++step) {
        const double t = step / 500.0;
        const glm::vec3 exact(reference.value(0, t), reference.value(1, t), reference.value(2, t));
        for (const glm::vec3& s : {exact, evaluate(segment, static_cast<float>(t))}) {
          const glm::vec3 far = s + glm::vec3(size.x, 0, size.z);
          sampled.add(s);
          sampled.add(far);
          for (int i = 0; i < 3; ++i) {
            ASSERT_GE(s[i], box.min[i]);
            ASSERT_LE(far[i], box.max[i]);
          }
        }
      }
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(box.min[i], sampled.min[i], 0.1f);
      EXPECT_NEAR(box.max[i], sampled.max[i], 0.1f);
    }
  }
}

TEST(Spline, BoundsAreTheExactRangeUpToRounding) { test::expectExactBounds(&deformedBounds); }
TEST(Spline, BoundsHoldForHugeNumbers) { test::expectBoundsOfHugeNumbers(&deformedBounds); }

// The quick answer for plain rigs and the thorough one are the same.
TEST(Spline, CheckKnotsAgreesWithIsMonotone) {
  std::mt19937 random(23);
  std::uniform_real_distribution<float> unit(0, 1);
  int yes = 0, no = 0;
  for (int n = 0; n < 100000; ++n) {
    std::vector<Knot> knots;
    for (const float at : {0.0f, 0.35f, 0.6f, 1.0f}) {
      knots.push_back({at,
                       {unit(random), 60 * (at + 0.2f * unit(random)), unit(random)},
                       {9 * unit(random), 60 * (4 * unit(random) - 0.2f), 0}});
    }
    bool expected = true;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i)
      expected = expected && isMonotone(makeSegment(knots[i], knots[i + 1], 1));
    ASSERT_EQ(static_cast<bool>(checkKnots(knots)), expected) << n;
    ++(expected ? yes : no);
  }
  EXPECT_GT(yes, 1000);
  EXPECT_GT(no, 1000);
}

TEST(Spline, BoundsOfTheStraightRigAreTheVolume) {
  const std::vector<Knot> knots = test::straightKnots();
  const Box box = deformedBounds(knots, {30, 70, 20});
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(box.min[i], 0, 1e-3f);
    EXPECT_NEAR(box.max[i], glm::vec3(30, 70, 20)[i], 1e-3f);
  }
  EXPECT_TRUE(deformedBounds({}, {30, 70, 20}).empty());
}

}  // namespace
}  // namespace kelp

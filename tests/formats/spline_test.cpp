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

#include "bound_knots.h"

namespace kelp {
namespace {

// The Hermite basis in its textbook form, in double precision: independent of the coefficients the library makes.
struct Reference {
  std::array<double, 3> p0, p1, m0, m1;

  Reference(const Knot& k0, const Knot& k1) {
    const double share = static_cast<double>(k1.at) - static_cast<double>(k0.at);
    for (int i = 0; i < 3; ++i) {
      p0[i] = k0.position[i];
      p1[i] = k1.position[i];
      m0[i] = share * k0.tangent[i];
      m1[i] = share * k1.tangent[i];
    }
  }
  double value(int i, double t) const {
    const double h00 = (1 + 2 * t) * (1 - t) * (1 - t), h10 = t * (1 - t) * (1 - t);
    const double h01 = t * t * (3 - 2 * t), h11 = t * t * (t - 1);
    return h00 * p0[i] + h10 * m0[i] + h01 * p1[i] + h11 * m1[i];
  }
  double slope(int i, double t) const {
    return (6 * t * t - 6 * t) * (p0[i] - p1[i]) + (3 * t * t - 4 * t + 1) * m0[i] + (3 * t * t - 2 * t) * m1[i];
  }
};

Knot randomKnot(std::mt19937& random, float at, float reach) {
  std::uniform_real_distribution<float> any(-reach, reach);
  return {at, {any(random), any(random), any(random)}, {any(random), any(random), any(random)}};
}

TEST(Spline, EvaluatesLikeTheHermiteBasisInDoublePrecision) {
  std::mt19937 random(1);
  for (int n = 0; n < 2000; ++n) {
    const Knot k0 = randomKnot(random, 0.25f, 500.0f);
    const Knot k1 = randomKnot(random, 0.75f, 500.0f);
    const Segment segment = makeSegment(k0, k1);
    const Reference reference(k0, k1);
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
  const Segment segment = makeSegment(k0, k1);
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
    const Segment lower = makeSegment({0, {0, 0, 0}, tangent}, {split, split * tangent, tangent});
    const Segment upper = makeSegment({split, split * tangent, tangent}, {1, tangent, tangent});
    for (const float t : {0.0f, 0.3f, 1.0f}) {
      EXPECT_NEAR(evaluate(lower, t).y, 96 * split * t, 1e-4f);
      EXPECT_NEAR(evaluate(upper, t).y, 96 * (split + (1 - split) * t), 1e-4f);
    }
  }
}

TEST(Spline, StraightKnotsAreTheIdentity) {
  Knot knots[2];
  straightKnots({30, 70, 20}, knots);
  ASSERT_TRUE(checkKnots(knots));
  const Segment segment = makeSegment(knots[0], knots[1]);
  for (const float t : {0.0f, 0.25f, 0.5f, 1.0f}) EXPECT_EQ(evaluate(segment, t), glm::vec3(0, 70 * t, 0));
}

// The largest fall of Sy below an earlier height, by dense sampling in double precision.
double sampledFall(const Reference& r) {
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
    const double fall = sampledFall(Reference(k0, k1)) / rise;
    if (fall > 2e-6 && fall < 2e-5) continue;  // too near to the tolerance for samples to tell
    const bool expected = fall <= 1e-5;
    ASSERT_EQ(isMonotone(makeSegment(k0, k1)), expected) << k0.tangent.y << " " << k1.tangent.y << " fall " << fall;
    ++(expected ? yes : no);
  }
  EXPECT_GT(yes, 300);
  EXPECT_GT(no, 300);
}

TEST(Spline, IsMonotoneHoldsAtItsLimits) {
  const auto segment = [](float rise, float m0, float m1) {
    return makeSegment({0, {0, 0, 0}, {0, m0, 0}}, {1, {0, rise, 0}, {0, m1, 0}});
  };
  // Fritsch and Carlson 1980: both tangents within 3 times the rise are always monotone; equal ones not beyond.
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
      knots.push_back({at, {side(random), at * 120, side(random)}, {side(random), 240 * unit(random), side(random)}});
    }
    if (!checkKnots(knots)) continue;
    const Box box = deformedBounds(knots, size);
    Box sampled;
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      const Reference reference(knots[k], knots[k + 1]);
      const Segment segment = makeSegment(knots[k], knots[k + 1]);
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

// The exact range of a coordinate, from the roots of its derivative in long double.
std::pair<long double, long double> exactRange(const Reference& r, int axis) {
  const long double rise = static_cast<long double>(r.p1[axis]) - r.p0[axis], m0 = r.m0[axis], m1 = r.m1[axis];
  const long double a = m0 + m1 - 2 * rise, b = 3 * rise - 2 * m0 - m1;
  const auto at = [&](long double t) { return r.p0[axis] + t * (m0 + t * (b + t * a)); };
  long double low = std::min(at(0), at(1)), high = std::max(at(0), at(1));
  const long double discriminant = b * b - 3 * a * m0;
  if (discriminant >= 0) {
    for (const long double q : {-b - std::sqrt(discriminant), -b + std::sqrt(discriminant)}) {
      for (const long double t : {q / (3 * a), m0 / q}) {
        if (!(t > 0 && t < 1)) continue;
        low = std::min(low, at(t));
        high = std::max(high, at(t));
      }
    }
  }
  return {low, high};
}

// Every kind of size, turns that nearly are none, and double roots: the box contains the exact range, and exceeds it by roundings only.
TEST(Spline, BoundsAreTheExactRangeUpToRounding) {
  std::mt19937 random(21);
  std::uniform_real_distribution<float> unit(-1, 1);
  const glm::ivec3 size(3, 5, 7);
  double worst = 0;
  int turning = 0;
  for (int n = 0; n < 200000; ++n) {
    const float scale = std::pow(10.0f, 3 * unit(random)), slope = scale * std::pow(10.0f, 2 * unit(random));
    std::vector<Knot> knots{randomKnot(random, 0, scale), randomKnot(random, 0.3f, scale), randomKnot(random, 1, scale)};
    for (Knot& knot : knots) knot.tangent *= slope / scale;
    if (n % 4 == 1) {  // the derivative nearly has a double root in the first segment: 12 (rise - m0) (rise - m1) .. 0
      const glm::vec3 rise = (knots[1].position - knots[0].position) / 0.3f;
      knots[0].tangent = rise * (1 + 1e-4f * unit(random));
      knots[1].tangent = rise * (4 + 1e-4f * unit(random));
    } else if (n % 4 == 2) {  // nearly no cubic term
      knots[1].tangent = 2.0f * (knots[1].position - knots[0].position) / 0.3f - knots[0].tangent + 1e-5f * slope * unit(random);
    } else if (n % 4 == 3) {  // flat ends
      knots[static_cast<std::size_t>(n / 4 % 3)].tangent = glm::vec3(0);
    }
    const Box box = deformedBounds(knots, size);
    long double low[3] = {1e30L, 1e30L, 1e30L}, high[3] = {-1e30L, -1e30L, -1e30L};
    double sizes = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      // The segment as the library rounds it is the segment.
      const Segment s = makeSegment(knots[k], knots[k + 1]);
      Reference r(knots[k], knots[k + 1]);
      for (int i = 0; i < 3; ++i) {
        r.m0[i] = s.m0[i];
        r.m1[i] = s.m1[i];
        const auto [least, most] = exactRange(r, i);
        turning += least < std::min(r.p0[i], r.p1[i]) || most > std::max(r.p0[i], r.p1[i]);
        low[i] = std::min(low[i], least);
        high[i] = std::max(high[i], most);
        sizes = std::max({sizes, std::abs(r.p0[i]), std::abs(r.p1[i]), std::abs(r.m0[i]), std::abs(r.m1[i])});
      }
    }
    for (int i = 0; i < 3; ++i) {
      const long double base = i == 0 ? size.x : i == 2 ? size.z : 0;
      ASSERT_LE(box.min[i], low[i]) << n;
      // One rounding for adding the base.
      ASSERT_GE(box.max[i], high[i] + base - 1e-6L) << n;
      worst = std::max({worst, static_cast<double>(low[i] - box.min[i]) / sizes, static_cast<double>(box.max[i] - high[i] - base) / (sizes + 1)});
    }
  }
  EXPECT_GT(turning, 100000);
  EXPECT_LT(worst, 1e-4);
}

// What a renderer asks each frame: true only for knots that are sound, and then the exact range with the margin; whatever the other seven rigs are, and
// however many lanes there are.
TEST(Spline, SoundRigsAreBoundEightAtATime) {
  std::mt19937 random(24);
  std::uniform_real_distribution<float> unit(-1, 1);
  const float margin = 0.25f;
  const auto boundsOf = [&](const std::array<std::span<const Knot>, 8>& rigs, unsigned& sound) {
    std::span<const Knot> lanes[8];
    std::copy(rigs.begin(), rigs.end(), lanes);
    BoxLanes boxes, by_four;
    sound = boundSoundKnots(lanes, margin, boxes);
    EXPECT_EQ(sound, four::boundSoundKnots(lanes, 0, margin, by_four) | four::boundSoundKnots(lanes, 4, margin, by_four) << 4);
    std::array<Box, 8> out;
    for (std::size_t rig = 0; rig < 8; ++rig) {
      for (int axis = 0; axis < 3; ++axis) {
        out[rig].min[axis] = boxes.min[axis].of[rig];
        out[rig].max[axis] = boxes.max[axis].of[rig];
        if (!(sound >> rig & 1)) continue;
        EXPECT_EQ(out[rig].min[axis], by_four.min[axis].of[rig]);
        EXPECT_EQ(out[rig].max[axis], by_four.max[axis].of[rig]);
      }
    }
    return out;
  };
  int bound = 0;
  std::array<std::vector<Knot>, 8> rigs;
  for (int n = 0; n < 100000; ++n) {
    const float scale = std::pow(10.0f, 3 * unit(random)), slope = scale * std::pow(10.0f, 2 * unit(random));
    std::vector<Knot>& knots = rigs[static_cast<std::size_t>(n) % 8];
    knots.clear();
    const int last = 1 + n % 3;
    for (int i = 0; i <= last; ++i) knots.push_back(randomKnot(random, i == last ? 1.0f : 0.3f * static_cast<float>(i), scale));
    for (Knot& knot : knots) {
      knot.position.y = scale * (knot.at + 0.2f * knot.at * unit(random));
      knot.tangent = glm::vec3(knot.tangent.x * slope / scale, scale * (1.5f + 1.7f * unit(random)), knot.tangent.z * slope / scale);
    }
    const std::size_t some = static_cast<std::size_t>(n / 50) % knots.size();
    if (n % 50 == 0) knots[some].position[n / 150 % 3] = n % 100 ? NAN : INFINITY;
    if (n % 50 == 1) knots[some].tangent[n / 150 % 3] = n % 100 == 1 ? NAN : -INFINITY;
    if (n % 50 == 2) knots[some].at = n % 100 == 2 ? NAN : 1;
    if (n % 50 == 3) knots.resize(n % 100 == 3 ? 0 : n % 150 == 3 ? 1 : kMaxKnots + 1);
    if (n % 8 != 7) continue;
    unsigned sound;
    std::array<std::span<const Knot>, 8> eight;
    std::copy(rigs.begin(), rigs.end(), eight.begin());
    const auto boxes = boundsOf(eight, sound);
    for (unsigned rig = 0; rig < 8; ++rig) {
      unsigned alone;
      std::array<std::span<const Knot>, 8> same;
      same.fill(rigs[rig]);
      const auto box_alone = boundsOf(same, alone)[0];
      ASSERT_EQ(alone, sound >> rig & 1 ? 255u : 0u) << n;
      if (!alone) continue;
      ++bound;
      const Box& box = boxes[rig];
      ASSERT_TRUE(box.min == box_alone.min && box.max == box_alone.max) << n;
      ASSERT_TRUE(checkKnots(rigs[rig])) << n;
      for (int i = 0; i < 3; ++i) {
        long double low = 1e30L, high = -1e30L, sizes = 0;
        for (std::size_t k = 0; k + 1 < rigs[rig].size(); ++k) {
          const Knot &k0 = rigs[rig][k], &k1 = rigs[rig][k + 1];
          const auto [least, most] = exactRange(Reference(k0, k1), i);
          low = std::min(low, least);
          high = std::max(high, most);
          const long double share = k1.at - k0.at;
          sizes = std::max({sizes, std::abs(least), std::abs(most), share * std::abs(k0.tangent[i]), share * std::abs(k1.tangent[i])});
        }
        ASSERT_LE(box.min[i], low - margin) << n;
        ASSERT_GE(box.max[i], high + margin - 1e-6L) << n;
        ASSERT_GE(box.min[i], low - margin - 1e-4L * (sizes + margin)) << n;
        ASSERT_LE(box.max[i], high + margin + 1e-4L * (sizes + margin)) << n;
      }
    }
  }
  EXPECT_GT(bound, 20000);
}

// Beyond where squares of coefficients end in float.
TEST(Spline, BoundsHoldForHugeNumbers) {
  std::mt19937 random(22);
  for (int n = 0; n < 1000; ++n) {
    std::vector<Knot> knots{randomKnot(random, 0, 1e25f), randomKnot(random, 1, 1e25f)};
    const Box box = deformedBounds(knots, {1, 1, 1});
    const Reference r(knots[0], knots[1]);
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = exactRange(r, i);
      ASSERT_LE(box.min[i], low);
      ASSERT_GE(box.max[i], high);
      ASSERT_LT(box.max[i] - box.min[i], 1.001L * (high - low));
    }
  }
}

// The quick answer for plain rigs and the thorough one are the same.
TEST(Spline, CheckKnotsAgreesWithIsMonotone) {
  std::mt19937 random(23);
  std::uniform_real_distribution<float> unit(0, 1);
  int yes = 0, no = 0;
  for (int n = 0; n < 100000; ++n) {
    std::vector<Knot> knots;
    for (const float at : {0.0f, 0.35f, 0.6f, 1.0f}) {
      knots.push_back({at, {unit(random), 60 * (at + 0.2f * unit(random)), unit(random)}, {9 * unit(random), 60 * (4 * unit(random) - 0.2f), 0}});
    }
    bool expected = true;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) expected = expected && isMonotone(makeSegment(knots[i], knots[i + 1]));
    ASSERT_EQ(static_cast<bool>(checkKnots(knots)), expected) << n;
    ++(expected ? yes : no);
  }
  EXPECT_GT(yes, 1000);
  EXPECT_GT(no, 1000);
}

TEST(Spline, BoundsOfTheStraightRigAreTheVolume) {
  Knot knots[2];
  straightKnots({30, 70, 20}, knots);
  const Box box = deformedBounds(knots, {30, 70, 20});
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(box.min[i], 0, 1e-3f);
    EXPECT_NEAR(box.max[i], glm::vec3(30, 70, 20)[i], 1e-3f);
  }
  EXPECT_TRUE(deformedBounds({}, {30, 70, 20}).empty());
}

}  // namespace
}  // namespace kelp

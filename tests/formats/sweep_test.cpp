// SPDX-License-Identifier: MIT
// Arcs of swept parts against what they approximate: the spline, and frames that are carried along it in
// small steps.
#include "kelp/formats/sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "reference/sweep_trials.h"
#include "reference/sweep_truth.h"

namespace kelp {
namespace {

using glm::dvec3;
using reference::SweepRig;

constexpr glm::ivec3 kSize{64, 256, 52};
constexpr double kHeight = 256;

// S(t) of the segment after knot i, straight from the definition, heights of the part.
dvec3 splineAt(std::span<const Knot> knots, std::size_t i, double t) {
  const Knot &a = knots[i], &b = knots[i + 1];
  const double u = 1 - t, share = double{b.at} - double{a.at};
  return u * u * (1 + 2 * t) * dvec3(a.position) + t * u * u * share * dvec3(a.tangent) +
         t * t * (3 - 2 * t) * dvec3(b.position) - t * t * u * share * dvec3(b.tangent);
}
dvec3 middleLine(std::span<const Knot> knots, std::size_t i, double t) {
  return kHeight * splineAt(knots, i, t) + dvec3(0.5 * kSize.x, 0, 0.5 * kSize.z);
}

ArcChain chainOf(const SweepRig& rig, float tolerance = kArcTolerance) {
  ArcChain chain{};
  const Result<void> made = makeArcs(rig.knots, kSize, rig.roll, tolerance, chain);
  EXPECT_TRUE(made) << rig.name << ": " << (made ? "" : made.error().detail);
  return chain;
}

std::vector<SweepRig> rigs() {
  std::vector<SweepRig> all = reference::namedSweeps(kSize);
  for (unsigned i = 0; i < 40; ++i) all.push_back(reference::randomSweep(kSize, i));
  return all;
}

// The tolerance that formats/README.md promises.
TEST(Sweep, TheCenterLineIsTheSplineWithinTheTolerance) {
  int rigs_beyond = 0, all = 0;
  for (const SweepRig& rig : rigs()) {
    const ArcChain chain = chainOf(rig);
    double worst = 0;
    for (std::size_t i = 0; i + 1 < rig.knots.size(); ++i) {
      for (int n = 0; n <= 200; ++n) {
        const dvec3 p = middleLine(rig.knots, i, n / 200.0);
        double nearest = 1e9;
        for (int a = 0; a < chain.count; ++a) {
          const Arc& arc = chain.arcs[a];
          const double low = chain.joints[a].y, high = chain.joints[a + 1].y;
          const int steps = 8 * static_cast<int>(high - low + 1);
          for (int m = 0; m <= steps; ++m) {
            const dvec3 rest(0.5 * kSize.x, low + (high - low) * m / steps, 0.5 * kSize.z);
            nearest = std::min(nearest, glm::distance(p, reference::swept(arc, kSize, rest)));
          }
        }
        worst = std::max(worst, nearest);
      }
    }
    // The samples above are up to 1/8 voxel apart, along the line.
    const double tolerance = kHeight * double{kArcTolerance}, between = 0.07;
    EXPECT_LT(worst, 4.7 * tolerance + between) << rig.name;
    rigs_beyond += worst > 2 * tolerance + between ? 1 : 0;
    ++all;
  }
  EXPECT_LE(rigs_beyond, all / 10);
}

// A span that runs back along itself, or nearly, is no straight part.
TEST(Sweep, ASplineThatTurnsBackInASpanIsRefused) {
  for (const float length : {5.0f, 30.0f, 1e6f})
    for (const float lean : {0.0f, 0.003f, 0.05f}) {
      const glm::vec3 tangent = length * glm::vec3(lean, 1, 0);
      const std::vector<Knot> knots{{0, {0, 0, 0}, tangent}, {1, {0, 1, 0}, tangent}};
      const Result<void> made = checkSweep(knots, kSize, 0);
      ASSERT_FALSE(made) << length << " " << lean;
      EXPECT_EQ(made.error().code, ErrorCode::kFolds);
    }
}

TEST(Sweep, KnotsStayAtTheirHeightsAndTheArcsMeet) {
  for (const SweepRig& rig : rigs()) {
    const ArcChain chain = chainOf(rig);
    int joint = 0;
    for (const Knot& knot : rig.knots) {
      while (joint < chain.count && chain.joints[joint].y < 256 * knot.at - 1e-3f) ++joint;
      EXPECT_NEAR(chain.joints[joint].y, 256 * knot.at, 1e-3f) << rig.name;
      const glm::mat4x3 section = sectionAt(chain, 256 * knot.at);
      EXPECT_LT(glm::distance(dvec3(section[3]), kHeight * dvec3(knot.position) + dvec3(32, 0, 26)), 0.002);
      EXPECT_GT(glm::dot(dvec3(section[1]), glm::normalize(dvec3(knot.tangent))), 1 - 1e-6) << rig.name;
    }
    EXPECT_EQ(joint, chain.count);
    for (int i = 0; i + 1 < chain.count; ++i) {
      const double y = chain.joints[i + 1].y;
      for (const dvec3 corner : {dvec3(0, y, 0), dvec3(64, y, 0), dvec3(13, y, 52)}) {
        const dvec3 a = reference::swept(chain.arcs[i], kSize, corner),
                    b = reference::swept(chain.arcs[i + 1], kSize, corner);
        EXPECT_LT(glm::distance(a, b), 0.003) << rig.name << " joint " << i + 1;
        const glm::vec4& plane = chain.joints[i + 1].plane;
        EXPECT_LT(std::abs(glm::dot(dvec3(plane), a) + double{plane.w}), 0.002) << rig.name;
      }
    }
  }
}

// Between two knots the height runs with the arc length, and no arc turns by more than 60 degrees.
TEST(Sweep, HeightRunsWithTheArcLength) {
  for (const SweepRig& rig : rigs()) {
    const ArcChain chain = chainOf(rig);
    for (int i = 0; i < chain.count; ++i) {
      const Arc& arc = chain.arcs[i];
      const double rise = double{chain.joints[i + 1].y} - double{chain.joints[i].y};
      EXPECT_NEAR(rise, 2 * double{arc.half_length} * double{arc.rise}, 1e-3) << rig.name;
      EXPECT_LE(2 * arc.half_length * arc.curvature, std::numbers::pi_v<float> / 3 * 1.0001f) << rig.name;
    }
    for (std::size_t i = 0; i + 1 < rig.knots.size(); ++i) {
      double length = 0;
      for (int n = 0; n < 2000; ++n)
        length +=
            glm::distance(middleLine(rig.knots, i, n / 2000.0), middleLine(rig.knots, i, (n + 1) / 2000.0));
      const double share = kHeight * (double{rig.knots[i + 1].at} - double{rig.knots[i].at});
      const double middle = kHeight * 0.5 * (double{rig.knots[i].at} + double{rig.knots[i + 1].at});
      int at = 0;
      while (chain.joints[at + 1].y < middle) ++at;
      EXPECT_NEAR(double{chain.arcs[at].rise} * length / share, 1, 0.01) << rig.name << " span " << i;
    }
  }
}

// Against a frame that is carried along the spline in small steps without turning about it.
TEST(Sweep, SectionsDoNotTwist) {
  int compared = 0;
  for (const SweepRig& rig : rigs()) {
    ArcChain chain{};
    // More arcs show sharper turns, which may fold.
    if (!makeArcs(rig.knots, kSize, rig.roll, kArcTolerance / 16, chain)) continue;
    ++compared;
    dvec3 x(chain.start_x), t = glm::normalize(dvec3(rig.knots[0].tangent));
    for (std::size_t i = 0; i + 1 < rig.knots.size(); ++i) {
      for (int n = 1; n <= 4000; ++n) {
        const double s = n / 4000.0, h = 1e-5;
        const dvec3 next = glm::normalize(splineAt(rig.knots, i, std::min(s + h, 1.0)) -
                                          splineAt(rig.knots, i, std::min(s + h, 1.0) - 2 * h));
        x = glm::normalize(x - glm::dot(x, next) * next);
        t = next;
      }
      const glm::mat4x3 section = sectionAt(chain, 256 * rig.knots[i + 1].at);
      EXPECT_GT(glm::dot(dvec3(section[0]), x), std::cos(0.03)) << rig.name << " knot " << i + 1;
    }
  }
  EXPECT_GT(compared, 40);
}

// The first section: turned from +y by the least, then rolled from x to -z.
TEST(Sweep, TheFirstSectionIsTurnedByTheLeastAndRolled) {
  std::mt19937 random(7);
  const auto unit = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  for (int i = 0; i < 200; ++i) {
    const dvec3 t = glm::normalize(dvec3(unit(), unit(), unit()));
    const double roll = 3 * unit();
    const std::vector<Knot> knots{{0, {}, glm::vec3(t)}, {1, glm::vec3(t), glm::vec3(t)}};
    ArcChain chain{};
    ASSERT_TRUE(makeArcs(knots, kSize, static_cast<float>(roll), kArcTolerance, chain));
    // By a quaternion, and the roll before it about +y.
    const glm::dquat turn = glm::normalize(glm::dquat(1 + t.y, glm::cross(dvec3(0, 1, 0), t)));
    const glm::dquat spin = glm::angleAxis(roll, dvec3(0, 1, 0));
    EXPECT_LT(glm::distance(turn * (spin * dvec3(1, 0, 0)), dvec3(chain.start_x)), 1e-5);
    EXPECT_LT(glm::distance(turn * (spin * dvec3(0, 0, 1)), dvec3(chain.start_z)), 1e-5);
  }
}

TEST(Sweep, ThicknessStaysAndTheVolumeIsThatOfTheSweep) {
  for (const double degrees : {30.0, 60.0, 90.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    SweepRig rig{"bend", {}, 0};
    for (int i = 0; i < 3; ++i) {
      const double a = turn * i / 2;
      rig.knots.push_back({0.5f * static_cast<float>(i),
                           glm::vec3((1 - std::cos(a)) / turn, std::sin(a) / turn, 0),
                           glm::vec3(std::sin(a), std::cos(a), 0)});
    }
    const ArcChain chain = chainOf(rig);
    double volume = 0, expected = 0;
    std::mt19937 random(1);
    const auto unit = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
    for (int n = 0; n < 2000; ++n) {
      const glm::vec3 rest(64 * unit(), 2 + 252 * unit(), 52 * unit());
      // Thickness: opposite points of the section.
      const glm::vec3 across(64 - rest.x, rest.y, 52 - rest.z);
      EXPECT_NEAR(glm::distance(sweepPoint(chain, kSize, rest), sweepPoint(chain, kSize, across)),
                  glm::distance(rest, across), 0.01f * glm::distance(rest, across) + 1e-3f);
      // The map's determinant, by differences in double.
      int arc = 0;
      while (chain.joints[arc + 1].y < rest.y) ++arc;
      const dvec3 p(rest);
      const auto at = [&](const dvec3& d) { return reference::swept(chain.arcs[arc], kSize, p + d); };
      const double h = 1e-3;
      const dvec3 dx = (at({h, 0, 0}) - at({-h, 0, 0})) / (2 * h),
                  dy = (at({0, h, 0}) - at({0, -h, 0})) / (2 * h),
                  dz = (at({0, 0, h}) - at({0, 0, -h})) / (2 * h);
      volume += glm::dot(dx, glm::cross(dy, dz));
      expected += 1 - turn / kHeight * (p.x - 32);
    }
    EXPECT_NEAR(volume / expected, 1, 0.005) << degrees;
  }
}

TEST(Sweep, PointsGoThereAndBack) {
  std::mt19937 random(3);
  const auto unit = [&] { return std::uniform_real_distribution<float>(0, 1)(random); };
  for (const SweepRig& rig : rigs()) {
    const ArcChain chain = chainOf(rig);
    int same = 0;
    for (int n = 0; n < 300; ++n) {
      const glm::vec3 rest(64 * unit(), 256 * unit(), 52 * unit());
      const glm::vec3 world = sweepPoint(chain, kSize, rest);
      EXPECT_TRUE(world.x >= chain.bounds.min.x && world.y >= chain.bounds.min.y &&
                  world.z >= chain.bounds.min.z && world.x <= chain.bounds.max.x &&
                  world.y <= chain.bounds.max.y && world.z <= chain.bounds.max.z)
          << rig.name;
      const std::optional<glm::vec3> found = unsweepPoint(chain, kSize, world);
      ASSERT_TRUE(found) << rig.name;
      const glm::vec3 back = *found;
      if (glm::distance(back, rest) < 0.01f) {
        ++same;
        continue;
      }
      // Coils overlap there: it is another place that lies there too, no farther from the center line.
      EXPECT_LT(glm::distance(sweepPoint(chain, kSize, back), world), 0.01f) << rig.name;
      const auto off = [](const glm::vec3& p) { return glm::length(glm::vec2(p.x - 32, p.z - 26)); };
      EXPECT_LE(off(back), off(rest) + 0.01f) << rig.name;
    }
    EXPECT_GT(same, 200) << rig.name;
  }
}

TEST(Sweep, BallsContainTheirSlices) {
  for (const SweepRig& rig : rigs()) {
    const ArcChain chain = chainOf(rig);
    for (int i = 0; i < chain.count; ++i) {
      const double low = chain.joints[i].y, high = chain.joints[i + 1].y;
      for (int n = 0; n <= 40; ++n) {
        const double y = low + (high - low) * n / 40;
        for (const dvec3 corner : {dvec3(0, y, 0), dvec3(64, y, 0), dvec3(0, y, 52), dvec3(64, y, 52)})
          EXPECT_LE(
              glm::distance(reference::swept(chain.arcs[i], kSize, corner), dvec3(chain.arcs[i].middle)),
              double{chain.arcs[i].radius})
              << rig.name;
      }
    }
  }
}

ErrorCode codeOf(const std::vector<Knot>& knots, const char* detail, std::uint64_t knot) {
  ArcChain chain{};
  const Result<void> made = makeArcs(knots, kSize, 0, kArcTolerance, chain);
  EXPECT_FALSE(made);
  if (made) return ErrorCode::kIo;
  EXPECT_NE(std::string(made.error().detail).find(detail), std::string::npos) << made.error().detail;
  EXPECT_EQ(made.error().offset, knot);
  return made.error().code;
}

TEST(Sweep, WhatCannotBeSweptIsRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Knot> straight{
      {0, {0, 0, 0}, {0, 1, 0}}, {0.5f, {0, 0.5f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  ASSERT_TRUE(checkSweep(straight, kSize, 0));
  const auto with = [&](std::size_t knot, auto change) {
    std::vector<Knot> knots = straight;
    change(knots[knot]);
    return knots;
  };
  EXPECT_EQ(codeOf(with(1, [](Knot& k) { k.tangent = {}; }), "tangent", 1), ErrorCode::kMisuse);
  EXPECT_EQ(codeOf(with(1, [](Knot& k) { k.position = {}; }), "one point", 0), ErrorCode::kMisuse);
  EXPECT_EQ(codeOf(with(2, [](Knot& k) { k.position.y = 0.5f; }), "one point", 1), ErrorCode::kMisuse);
  EXPECT_EQ(codeOf(with(1, [=](Knot& k) { k.tangent.x = kNan; }), "not finite", 1), ErrorCode::kMisuse);
  EXPECT_EQ(codeOf(with(2, [](Knot& k) { k.position.x = 1e30f; }), "too far", 2), ErrorCode::kMisuse);
  EXPECT_EQ(codeOf(with(1, [](Knot& k) { k.at = 1; }), "ascend", 2), ErrorCode::kMisuse);
  // Antiparallel tangents, a turn far too sharp, a spline that runs back through itself.
  EXPECT_EQ(codeOf(with(2, [](Knot& k) { k.tangent = {0, -1, 0}; }), "turns back", 1), ErrorCode::kFolds);
  EXPECT_EQ(codeOf(with(1, [](Knot& k) { k.position = {0.6f, 0.1f, 0}; }), "sharply", 0), ErrorCode::kFolds);
  EXPECT_EQ(codeOf(with(1,
                        [](Knot& k) {
                          k.tangent = {1e-30f, -1e-30f, 0};
                        }),
                   "sharply", 0),
            ErrorCode::kFolds);
  ArcChain chain{};
  EXPECT_FALSE(makeArcs(straight, kSize, kNan, kArcTolerance, chain));
  EXPECT_FALSE(makeArcs(straight, kSize, 0, 0, chain));
}

// Any numbers end in a sound chain or an error.
TEST(Sweep, AnyNumbersEnd) {
  std::mt19937 random(11);
  constexpr float kEqual[] = {0, 1, -1, 1e8f, -1e8f, 9e8f, 1e-7f, 1e-38f};
  bool equal = false;  // coordinates that are equal or cancel out
  const auto wild = [&] {
    if (equal) return kEqual[random() % std::size(kEqual)];
    const double e = std::uniform_real_distribution<double>(-12, 12)(random);
    return static_cast<float>((random() & 1 ? -1 : 1) * std::pow(10.0, random() % 3 ? 0.1 * e : e));
  };
  int good = 0;
  for (int n = 0; n < 40000; ++n) {
    equal = n % 2 > 0;
    std::vector<Knot> knots(2 + random() % 4);
    for (std::size_t i = 0; i < knots.size(); ++i)
      knots[i] = {static_cast<float>(i) / static_cast<float>(knots.size() - 1),
                  {wild(), wild(), wild()},
                  {wild(), wild(), wild()}};
    ArcChain chain{};
    if (!makeArcs(knots, {1, 1 + static_cast<int>(random() % 300), 1}, wild(), kArcTolerance, chain))
      continue;
    ++good;
    ASSERT_GE(chain.count, 1);
    ASSERT_LE(chain.count, kMaxArcs);
    for (int i = 0; i < chain.count; ++i) {
      const Arc& a = chain.arcs[i];
      ASSERT_TRUE(std::isfinite(a.middle.x + a.along.x + a.inward.x + a.curvature + a.y + a.radius)) << n;
      ASSERT_TRUE(a.rise > 0 && std::isfinite(a.rise)) << n;
      ASSERT_NEAR(glm::length(a.along), 1, 1e-5);
      ASSERT_NEAR(glm::length(a.inward), 1, 1e-5);
      ASSERT_NEAR(glm::dot(a.along, a.inward), 0, 1e-5);
    }
  }
  EXPECT_GT(good, 500);
}

// Far away, rounding can make an arc that halves do not make shorter.
TEST(Sweep, ArcsFarAwayEnd) {
  const std::vector<Knot> knots{{0, {1e8f, -1e8f, -1e8f}, {1e-7f, -1, 1e-7f}},
                                {1, {1e8f, 1, -1e8f}, {1e-38f, 9e8f, 1e-7f}}};
  const Result<void> made = checkSweep(knots, {1, 158, 1}, 0);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kFolds);
}

}  // namespace
}  // namespace kelp

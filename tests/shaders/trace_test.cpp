// SPDX-License-Identifier: MIT
// trace.glsl, compiled as C++, against the double-precision ground truth: nothing skipped, nothing invented.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/ground_truth.h"
#include "support/all_tests.h"
#include "support/boxed_level.h"
#include "support/poses.h"
#include "support/traced_level.h"
#include "support/voxel_knots.h"
#include "trace_cpp.h"

namespace kelp {
namespace {

struct Scene {
  fields::Occupancy volume;
  RawLevel level;
  glm::ivec3 size0;
  int level_index = 0;
};

Scene makeScene(fields::Occupancy volume, int level_index = 0) {
  Scene scene;
  scene.size0 = volume.size;
  scene.level_index = level_index;
  for (int i = 0; i < level_index; ++i) volume = fields::coarser(volume);
  scene.level = test::boxedLevel(volume, test::plainSurface(volume), 2);
  scene.volume = std::move(volume);
  return scene;
}

struct Posed {
  Posed(const Scene& scene, std::vector<Knot> knots_) : knots(std::move(knots_)) {
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      const Segment s = makeSegment(knots[i], knots[i + 1], static_cast<float>(scene.size0.y));
      segments.push_back({s.p0, s.m0, s.p1, s.m1});
    }
    const Box box = deformedBounds(knots, scene.size0);
    context.segments = segments.data();
    context.segment_count = static_cast<int>(segments.size());
    context.bounds_min = box.min;
    context.bounds_max = box.max;
    context.size = glm::vec3(scene.size0);
    context.level_size = scene.volume.size;
    context.level_scale = std::ldexp(1.0f, -scene.level_index);
    level = test::tracedLevel(scene.level, scene.volume.size);
    context.levels = &level;
  }
  std::vector<Knot> knots;
  std::vector<trace::KelpSegment> segments;
  trace::Level level;
  trace::Context context;
};

// Rays of every awkward kind through the deformed volume.
struct RayMaker {
  const Scene& scene;
  const Posed& posed;
  std::mt19937 random{7};

  float unit() { return std::uniform_real_distribution<float>(0, 1)(random); }
  // A point of the deformed volume.
  glm::vec3 inside() {
    const Knot& low = posed.knots.front();
    const Knot& high = posed.knots.back();
    const float y = low.position.y + unit() * (high.position.y - low.position.y);
    for (const auto& g : posed.segments) {
      const float end = g.p1.y;
      if (y <= end || &g == &posed.segments.back()) {
        const glm::vec3 s = trace::kelpSplineAt(g, trace::kelpSplineParameter(g, y - g.p0.y, g.p1.y - y));
        return {s.x + unit() * posed.context.size.x, y, s.z + unit() * posed.context.size.z};
      }
    }
    return {};
  }
  void make(int kind, glm::vec3& o, glm::vec3& r) {
    const glm::vec3 target = inside();
    glm::vec3 d = glm::normalize(glm::vec3(unit(), unit(), unit()) - 0.5f + glm::vec3(1e-4f, 0, 0));
    // along the spline, about
    if (kind == 1) d = glm::normalize(inside() - target + glm::vec3(1e-3f, 1e-3f, 0));
    if (kind == 2) d = glm::normalize(glm::vec3(d.x + 1e-3f, 0, d.z));            // exactly horizontal
    if (kind == 3) d = glm::normalize(glm::vec3(d.x + 1e-3f, 1e-5f * d.y, d.z));  // nearly
    if (kind == 4) {                                                              // along an axis
      d = glm::vec3(0);
      d[static_cast<int>(unit() * 2.999f)] = unit() < 0.5f ? -1.0f : 1.0f;
    }
    r = d;
    // 5: starts inside
    const float back =
        kind == 5 ? 0.0f : 3.0f * glm::length(posed.context.bounds_max - posed.context.bounds_min) * unit();
    // As the callers do: the origin where the ray enters the bounds.
    glm::vec3 from = target - back * d;
    float enter = 0;
    for (int a = 0; a < 3; ++a) {
      if (d[a] == 0) continue;
      const float s = std::min((posed.context.bounds_min[a] - from[a]) / d[a],
                               (posed.context.bounds_max[a] - from[a]) / d[a]);
      enter = std::max(enter, s);
    }
    o = from + enter * d;
  }
};

struct Tally {
  int rays = 0, hits = 0, missed = 0, invented = 0, late = 0, early = 0, wrong_voxel = 0;
  double steps = 0;
};

constexpr int kRayKinds = 6;

Tally compare(const Scene& scene, std::vector<Knot> knots, int rays_per_kind) {
  const Posed posed(scene, std::move(knots));
  RayMaker rays{scene, posed};
  reference::Volume truth{scene.volume.size, scene.volume.solid,
                          static_cast<double>(posed.context.level_scale), scene.size0};
  // kelp promises voxels shrunk by KELP_ERODE; the rest of this margin is float32's, at coordinates of
  // thousands of voxels.
  const double margin = 2.0 * double{KELP_ERODE};
  Tally tally;
  for (int kind = 0; kind < kRayKinds; ++kind) {
    for (int i = 0; i < rays_per_kind; ++i) {
      glm::vec3 o, r;
      rays.make(kind, o, r);
      const float s_max = 4.0f * glm::length(posed.context.bounds_max - posed.context.bounds_min);
      const trace::KelpHit hit = trace::kelpTrace(posed.context, o, r, 0.0f, s_max);
      const auto certain =
          reference::firstTouch(truth, posed.knots, glm::dvec3(o), glm::dvec3(r), 0.0, s_max, margin);
      ++tally.rays;
      tally.steps += hit.steps;
      if (!hit.found) {
        tally.missed += certain.has_value();
        continue;
      }
      ++tally.hits;
      const auto possible =
          reference::firstTouch(truth, posed.knots, glm::dvec3(o), glm::dvec3(r), 0.0, s_max, -margin);
      if (!possible) {
        ++tally.invented;
        continue;
      }
      tally.early += hit.s < possible->s - 2e-3;
      tally.late += certain && hit.s > certain->s + 2e-3;
      tally.wrong_voxel += !scene.volume.solid[scene.volume.index(hit.voxel)];
    }
  }
  return tally;
}

void expectExact(const Tally& tally, const char* what) {
  EXPECT_EQ(tally.missed, 0) << what << ": of " << tally.hits << " hits";
  EXPECT_EQ(tally.invented, 0) << what;
  EXPECT_EQ(tally.early, 0) << what;
  EXPECT_EQ(tally.late, 0) << what;
  EXPECT_EQ(tally.wrong_voxel, 0) << what;
  EXPECT_GT(tally.hits, tally.rays / 50) << what << ": the rays hit too little to prove anything";
}

TEST(Trace, FindsEveryHitInFigure6PosesOfAClump) {
  const Scene scene = makeScene(test::ballClump({96, 120, 72}, 24, 1));
  for (const auto& pose : test::kFigure6)
    expectExact(compare(scene, test::figureKnots(pose), test::shareOf(6000)), pose.name);
}

TEST(Trace, FindsEveryHitInFigure6PosesOfDust) {
  const Scene scene = makeScene(test::dust({61, 64, 67}, 400, 2));
  for (const auto& pose : test::kFigure6)
    expectExact(compare(scene, test::figureKnots(pose), test::shareOf(6000)), pose.name);
}

TEST(Trace, FindsEveryHitInFigure6PosesOfPlatesAndRods) {
  const Scene scene = makeScene(test::platesAndRods({70, 90, 50}));
  for (const auto& pose : test::kFigure6)
    expectExact(compare(scene, test::figureKnots(pose), test::shareOf(6000)), pose.name);
}

TEST(Trace, FindsEveryHitAtACoarserLevelOfOddSize) {
  const Scene scene = makeScene(test::ballClump({97, 121, 73}, 24, 3), 1);
  for (const auto& pose : test::kFigure6)
    expectExact(compare(scene, test::figureKnots(pose), test::shareOf(4000)), pose.name);
}

TEST(Trace, FindsEveryHitThroughSeveralSegments) {
  const Scene scene = makeScene(test::dust({60, 100, 50}, 300, 4));
  const std::vector<Knot> knots{{0, {0, 0, 0}, {0.5f, 1, 0}},
                                {0.2f, {0.15f, 0.2f, -0.05f}, {-0.8f, 0.6f, 0.4f}},
                                {0.65f, {-0.2f, 0.7f, 0.1f}, {0.3f, 0, -0.6f}},
                                {1, {0.1f, 1, 0}, {0, 1, 0}}};
  ASSERT_TRUE(checkKnots(knots));
  expectExact(compare(scene, knots, test::shareOf(10000)), "four knots");
}

TEST(Trace, FindsEveryHitWhenStretchedAndSquashed) {
  const Scene scene = makeScene(test::ballClump({64, 80, 64}, 20, 5));
  for (const float height : {20.0f, 60.0f, 250.0f}) {
    const std::vector<Knot> knots =
        test::inHeights({{0, {0, 5, 0}, {30, height, 10}}, {1, {10, 5 + height, -20}, {-60, height, 0}}}, 80);
    ASSERT_TRUE(checkKnots(knots));
    expectExact(compare(scene, knots, 5000), "stretched");
  }
}

TEST(Trace, StepsAreFew) {
  const Scene scene = makeScene(test::ballClump({128, 128, 128}, 12, 6));
  const Tally tally = compare(scene, test::figureKnots(test::kFigure6[1]), 500);
  EXPECT_LT(tally.steps / tally.rays, 9.0);  // constant steps of 0.001 take hundreds
}

TEST(Trace, ReachesTheEndOfALongNarrowChannel) {
  // Nothing to leap over: one step a voxel, more than any other ray takes.
  fields::Occupancy volume{{5, 5, 6000}, std::vector<std::uint8_t>(5 * 5 * 6000, 1)};
  for (int z = 0; z < 5999; ++z) volume.solid[volume.index({2, 2, z})] = 0;
  const Scene scene = makeScene(std::move(volume));
  const Posed posed(scene, test::figureKnots(test::kFigure6[0]));
  const trace::KelpHit hit = trace::kelpTrace(posed.context, {2.5f, 2.5f, 0}, {0, 0, 1}, 0, 1e6f);
  ASSERT_TRUE(hit.found);
  EXPECT_EQ(hit.voxel, glm::ivec3(2, 2, 5999));
}

TEST(Trace, SplineParameterInvertsHeightToFloatPrecision) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 20000; ++i) {
    // Monotone by construction: slopes m0, m1 >= 0 with m0^2 + m1^2 <= 9 rise^2; every third at the limit,
    // every fifth flat at both ends.
    const float rise = 10.0f + 500.0f * unit(random);
    const float angle = 1.5707963f * unit(random);
    const float size = i % 3 == 0 ? 3.0f : 3.0f * unit(random);
    const float m0 = i % 5 == 0 ? 0.0f : rise * size * std::cos(angle);
    const float m1 = i % 5 == 0 ? 0.0f : rise * size * std::sin(angle);
    const Segment s = makeSegment({0, {0, 3, 0}, {0, m0, 0}}, {1, {0, 3 + rise, 0}, {0, m1, 0}}, 1);
    const trace::KelpSegment g{s.p0, s.m0, s.p1, s.m1};
    const float y = 3.0f + rise * unit(random);
    const double t = static_cast<double>(trace::kelpSplineParameter(g, y - g.p0.y, g.p1.y - y));
    const double back = 3.0 + t * (double{m0} + t * (3.0 * double{rise} - 2.0 * double{m0} - double{m1} +
                                                     t * (double{m0} + double{m1} - 2.0 * double{rise})));
    ASSERT_NEAR(back, double{y}, 4e-6 * (3.0 + double{rise}) + 1e-5)
        << "m0 " << m0 << " m1 " << m1 << " rise " << rise;
  }
}

TEST(Trace, DeformedNormalIsTheInverseTransposeOfTheMap) {
  const Segment s = makeSegment({0, {0, 0, 0}, {30, 60, -20}}, {1, {5, 80, 9}, {-40, 90, 70}}, 1);
  const trace::KelpSegment g{s.p0, s.m0, s.p1, s.m1};
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 1000; ++i) {
    const float t = 0.02f + 0.96f * static_cast<float>(i) / 1000.0f;
    const glm::vec3 n(normal(random), normal(random), normal(random));
    const float stretch = 1.7f;
    // Two directions of the undeformed surface, pushed forward by finite differences of the map's inverse: (x
    // + Sx(t), y, z + Sz(t)).
    const auto forward = [&](const glm::dvec3& rest) {
      const double y = rest.y / double{stretch};
      double lo = 0, hi = 1;
      const auto at = [&](double u) {
        const double v = 1 - u;
        return v * v * (1 + 2 * u) * glm::dvec3(s.p0) + u * v * v * glm::dvec3(s.m0) +
               u * u * (3 - 2 * u) * glm::dvec3(s.p1) - u * u * v * glm::dvec3(s.m1);
      };
      for (int k = 0; k < 100; ++k) (at(0.5 * (lo + hi)).y < y ? lo : hi) = 0.5 * (lo + hi);
      const glm::dvec3 p = at(lo);
      return glm::dvec3(rest.x + p.x, y, rest.z + p.z);
    };
    const glm::dvec3 u = glm::normalize(
        glm::cross(glm::dvec3(n), glm::abs(n.x) < glm::abs(n.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 v = glm::normalize(glm::cross(glm::dvec3(n), u));
    const glm::dvec3 rest(3, double{stretch} * static_cast<double>(evaluate(s, t).y), 4);
    const double h = 1e-4;
    const glm::dvec3 du = forward(rest + h * u) - forward(rest - h * u);
    const glm::dvec3 dv = forward(rest + h * v) - forward(rest - h * v);
    glm::dvec3 expected = glm::normalize(glm::cross(du, dv));
    if (glm::dot(glm::cross(u, v), glm::dvec3(n)) < 0) expected = -expected;
    const glm::dvec3 got = glm::normalize(glm::dvec3(trace::kelpDeformNormal(g, t, stretch, n)));
    ASSERT_GT(glm::dot(got, expected), 1.0 - 1e-5) << "t " << t;
  }
}

TEST(Trace, DecodesNormalsAsTheFormatDoes) {
  for (std::uint32_t bits = 0; bits < (1u << 24); bits += 37) {
    ASSERT_LT(glm::distance(trace::kelpDecodeNormal(bits), decodeNormal(bits)), 1e-6f) << bits;
  }
}

}  // namespace
}  // namespace kelp

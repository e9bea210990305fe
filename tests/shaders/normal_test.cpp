// SPDX-License-Identifier: MIT
// kelpDeformNormal against finite differences of deformed fields in double precision, which know nothing of
// how normals transform; and the paper's equation 5 beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/deformed_field.h"
#include "reference/paper_cpp.h"
#include "reference/trials.h"
#include "support/all_tests.h"
#include "support/poses.h"
#include "support/traced_level.h"

namespace kelp {
namespace {

using glm::dvec3;
using reference::Spread;

struct Errors {
  std::vector<double> ours, paper;  // degrees
};

// Points of every shape, at heights that a float32 height stands for: what is measured is the transform and
// its parameter, not the place.
Errors errorsOf(const std::vector<Knot>& knots, const glm::ivec3& size, int points, unsigned seed) {
  const reference::SplineMap map(knots, size);
  std::vector<trace::KelpSegment> segments;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment s = makeSegment(knots[i], knots[i + 1], static_cast<float>(size.y));
    segments.push_back({s.p0, s.m0, s.p1, s.m1});
  }
  Errors errors;
  std::mt19937 random(seed);
  for (const reference::Shape& shape : reference::shapesIn(size)) {
    for (int i = 0; i < points; ++i) {
      const dvec3 q = shape.surfacePoint(random);
      const dvec3 p = map.toDeformed(q);
      if (map.toKnot(p.y) < reference::kRoom) continue;
      const dvec3 truth = reference::differenceNormal(shape.field, map, p);
      const trace::KelpSegment& g = segments[static_cast<std::size_t>(map.placeOf(p.y).segment)];
      const float t = trace::kelpSplineParameter(g, static_cast<float>(p.y - double{g.p0.y}),
                                                 static_cast<float>(double{g.p1.y} - p.y));
      const glm::vec3 n(shape.normal(q));
      errors.ours.push_back(reference::degreesBetween(
          dvec3(trace::kelpDeformNormal(g, t, static_cast<float>(map.stretch()), n)), truth));
      errors.paper.push_back(
          reference::degreesBetween(dvec3(paper::paperNormal(paper::paperSpline(g), t, n)), truth));
    }
  }
  return errors;
}

void expectTight(const Spread& spread, const std::string& what) {
  EXPECT_LT(spread.mean, 0.0002) << what;  // degrees; 0.5 would do
  EXPECT_LT(spread.p99, 0.002) << what;
  EXPECT_LT(spread.worst, 0.05) << what;
}

const glm::ivec3 kSize{256, 249, 195};

// As the product does it: the spline's parameter is the one that the trace reports with its hit.
Spread errorsAtHits(const reference::TrialVolume& volume, const std::vector<Knot>& knots, int rays,
                    unsigned seed) {
  const reference::SplineMap map(knots, volume.size);
  std::vector<trace::KelpSegment> segments;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment s = makeSegment(knots[i], knots[i + 1], static_cast<float>(volume.size.y));
    segments.push_back({s.p0, s.m0, s.p1, s.m1});
  }
  const Box bounds = deformedBounds(knots, volume.size);
  trace::Context context;
  context.segments = segments.data();
  context.segment_count = static_cast<int>(segments.size());
  context.bounds_min = bounds.min;
  context.bounds_max = bounds.max;
  context.size = glm::vec3(volume.size);
  context.level_size = volume.size;
  const trace::Level level = test::tracedLevel(volume.level, volume.size);
  context.levels = &level;

  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto direction = [&] {
    return glm::normalize(dvec3(normal(random), normal(random), normal(random)));
  };
  std::vector<double> errors;
  for (int i = 0; i < rays; ++i) {
    const dvec3 target = map.toDeformed(dvec3(volume.size) * dvec3(unit(random), unit(random), unit(random)));
    const glm::vec3 r(direction()), o(target - 200.0 * dvec3(r));
    const trace::KelpHit hit = trace::kelpTrace(context, o, r, 0.0f, 1000.0f);
    if (!hit.found) continue;
    const dvec3 p = dvec3(o) + double{hit.s} * dvec3(r), rest = map.toRest(p), n = direction();
    if (map.toKnot(p.y) < reference::kRoom) continue;  // on an end plane, to rounding
    const dvec3 truth =
        reference::differenceNormal([&](const dvec3& q) { return glm::dot(q - rest, n); }, map, p);
    const glm::vec3 ours = trace::kelpDeformNormal(segments[static_cast<std::size_t>(hit.segment)], hit.t,
                                                   static_cast<float>(map.stretch()), glm::vec3(n));
    errors.push_back(reference::degreesBetween(dvec3(ours), truth));
  }
  EXPECT_GT(errors.size(), static_cast<std::size_t>(rays / 20));
  return reference::spreadOf(errors);
}

// The truth itself: where nothing is bent, differences of the field are the shape's analytic normal.
TEST(Normals, DifferencesAreTheShapesNormalsAtRest) {
  const std::vector<Knot> knots = test::figureKnots(test::kFigure6[0]);
  const reference::SplineMap map(knots, kSize);
  std::mt19937 random(1);
  for (const reference::Shape& shape : reference::shapesIn(kSize)) {
    for (int i = 0; i < 500; ++i) {
      const dvec3 q = shape.surfacePoint(random);
      ASSERT_LT(std::abs(shape.field(q)), 1e-9) << shape.name;
      ASSERT_LT(reference::degreesBetween(reference::differenceNormal(shape.field, map, map.toDeformed(q)),
                                          shape.normal(q)),
                1e-5)
          << shape.name;
    }
  }
}

TEST(Normals, TransformIsExactInEveryPoseOfFigure6) {
  for (const test::FigurePose& figure : test::kFigure6) {
    const Errors errors = errorsOf(test::figureKnots(figure), kSize, 4000, 7);
    const Spread ours = reference::spreadOf(errors.ours), paper = reference::spreadOf(errors.paper);
    std::printf(
        "%-20s ours %.6f %.6f %.6f   equation 5 %.3f %.3f %.3f degrees: mean, 99th percentile, maximum\n",
        figure.name, ours.mean, ours.p99, ours.worst, paper.mean, paper.p99, paper.worst);
    expectTight(ours, figure.name);
  }
}

TEST(Normals, TransformIsExactForRandomRigs) {
  std::vector<double> all;
  for (unsigned seed = 0; seed < static_cast<unsigned>(test::shareOf(40)); ++seed) {
    const reference::TrialRig rig = reference::randomRig(kSize, seed);
    const Spread ours = reference::spreadOf(errorsOf(rig.knots, kSize, 400, seed).ours);
    expectTight(ours, rig.name);
    all.push_back(ours.worst);
  }
  std::printf("random rigs: maximum %.6f degrees\n", *std::max_element(all.begin(), all.end()));
}

TEST(Normals, TransformIsExactWhereRaysHit) {
  const reference::TrialVolume volume = reference::wholeVolume("clump", test::ballClump(kSize, 60, 3));
  for (const reference::TrialRig& rig : reference::namedRigs(kSize)) {
    const Spread spread = errorsAtHits(volume, rig.knots, 6000, 5);
    std::printf("%-20s at hits %.6f %.6f %.6f degrees\n", rig.name.c_str(), spread.mean, spread.p99,
                spread.worst);
    // The last rig stands still in y at a knot: there the parameter's own rounding shows.
    EXPECT_LT(spread.mean, 0.001) << rig.name;
    EXPECT_LT(spread.p99, 0.005) << rig.name;
    EXPECT_LT(spread.worst, 0.3) << rig.name;
  }
}

// Equation 5 is right at rest; every other pose of Figure 6 bends in two axes.
TEST(Normals, TheTransformBeatsEquation5WhereTwoAxesBend) {
  for (const test::FigurePose& figure : test::kFigure6) {
    const bool at_rest = figure.first == glm::vec3(0, 1, 0);
    const Errors errors = errorsOf(test::figureKnots(figure), kSize, 1000, 9);
    const Spread ours = reference::spreadOf(errors.ours), paper = reference::spreadOf(errors.paper);
    if (at_rest) {
      EXPECT_LT(paper.worst, 0.01);
    } else {
      EXPECT_GT(paper.mean, 2) << figure.name;
      EXPECT_GT(paper.mean, 10000 * ours.mean) << figure.name;
    }
  }
}

}  // namespace
}  // namespace kelp

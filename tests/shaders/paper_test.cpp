// SPDX-License-Identifier: MIT
// The paper's method (shaders/reference/paper.glsl, compiled as C++) does what the paper says: its parts
// against double precision, its marches against the ground truth. It is what kelp is measured against, so it
// must be neither broken nor better than published.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "reference/ground_truth.h"
#include "reference/paper_cpp.h"
#include "support/poses.h"
#include "support/voxel_knots.h"

namespace kelp {
namespace {

using glm::dvec3;

// S(t) of two knots, from the definition of Hermite splines.
struct Spline {
  explicit Spline(const std::vector<Knot>& knots)
      : p0(knots[0].position), p1(knots[1].position), m0(knots[0].tangent), m1(knots[1].tangent) {}
  dvec3 at(double t) const {
    const double u = 1 - t;
    return u * u * (1 + 2 * t) * p0 + t * u * u * m0 + t * t * (3 - 2 * t) * p1 - t * t * u * m1;
  }
  double parameter(double y) const {
    double low = 0, high = 1;
    for (int i = 0; i < 100; ++i) (at(0.5 * (low + high)).y < y ? low : high) = 0.5 * (low + high);
    return low;
  }
  dvec3 p0, p1, m0, m1;
};

struct PaperScene {
  PaperScene(fields::Occupancy volume_, const test::FigurePose& pose)
      : volume(std::move(volume_)), knots(test::figureKnots(pose)) {
    std::vector<std::uint32_t> squared(volume.solid.size());
    fields::squaredDistance(volume.solid, volume.size, squared, 1);
    distance.assign(squared.begin(), squared.end());
    for (float& d : distance) d = std::sqrt(d);
    const Segment s = makeSegment(knots[0], knots[1], static_cast<float>(volume.size.y));
    context.segment = {s.p0, s.m0, s.p1, s.m1};
    context.size = volume.size;
    context.distance = distance.data();
    context.step = 0.001f * static_cast<float>(std::max({volume.size.x, volume.size.y, volume.size.z}));
    bounds = deformedBounds(knots, volume.size);
  }
  reference::Volume truth() const { return {volume.size, volume.solid, 1.0, volume.size}; }

  fields::Occupancy volume;
  std::vector<Knot> knots;
  std::vector<float> distance;
  reference::PaperContext context;
  Box bounds;
};

fields::Occupancy solidBox(const glm::ivec3& size) {
  return {size,
          std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                        static_cast<std::size_t>(size.z),
                                    std::uint8_t{1})};
}

// A ray from around the bounds towards a point of the deformed volume.
struct Ray {
  glm::vec3 o, r;
};
class PaperRays {
 public:
  explicit PaperRays(const PaperScene& scene)
      : scene_(scene), spline_(test::inVoxels(scene.knots, static_cast<float>(scene.volume.size.y))) {}
  Ray operator()() {
    const dvec3 size(scene_.volume.size);
    const double y = size.y * unit();
    const dvec3 s = spline_.at(spline_.parameter(y));
    const dvec3 target(s.x + size.x * unit(), y, s.z + size.z * unit());
    const dvec3 d = glm::normalize(dvec3(unit(), unit(), unit()) - 0.5 + dvec3(1e-4, 0, 0));
    double back = 1e30;  // from the target backwards to the bounds
    for (int a = 0; a < 3; ++a) {
      if (d[a] != 0)
        back = std::min(back,
                        (target[a] - double{d[a] > 0 ? scene_.bounds.min[a] : scene_.bounds.max[a]}) / d[a]);
    }
    return {glm::vec3(target - back * d), glm::vec3(d)};
  }
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }

 private:
  const PaperScene& scene_;
  Spline spline_;
  std::mt19937 random_{17};
};

TEST(Paper, DepressedCubicFindsEveryRoot) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-2, 2);
  for (int i = 0; i < 20000; ++i) {
    // Three real roots, or one and a pair, multiplied out in double precision.
    const double scale = std::exp2(8 * unit(random));
    const double r0 = unit(random), r1 = unit(random), r2 = unit(random);
    const bool pair = i % 2 == 1;
    const double sum = pair ? 2 * r1 : r1 + r2;
    const double product = pair ? r1 * r1 + r2 * r2 + 0.01 : r1 * r2;
    const auto roots = paper::paperCubic(static_cast<float>(scale), static_cast<float>(-scale * (r0 + sum)),
                                         static_cast<float>(scale * (product + r0 * sum)),
                                         static_cast<float>(-scale * r0 * product));
    const auto nearest = [&](double r) {
      double best = 1e30;
      for (int k = 0; k < roots.count; ++k) best = std::min(best, std::abs(double{roots.t[k]} - r));
      return best;
    };
    // Near a double root float32 knows the root to the square root of its precision only, and may lose the
    // pair.
    if (pair) {
      ASSERT_LT(nearest(r0), 2e-3) << "roots " << r0 << ", " << r1 << " +- i " << r2;
    } else if (std::min({std::abs(r0 - r1), std::abs(r1 - r2), std::abs(r2 - r0)}) > 0.05) {
      ASSERT_EQ(roots.count, 3);
      for (const double r : {r0, r1, r2}) ASSERT_LT(nearest(r), 2e-3) << r0 << ", " << r1 << ", " << r2;
    }
  }
}

TEST(Paper, CubicThatIsNoneIsSolvedAsWhatItIs) {
  const auto quadratic = paper::paperCubic(0.0f, 2.0f, -3.0f, 1.0f);
  ASSERT_EQ(quadratic.count, 2);
  EXPECT_NEAR(std::min(quadratic.t.x, quadratic.t.y), 0.5f, 1e-6f);
  EXPECT_NEAR(std::max(quadratic.t.x, quadratic.t.y), 1.0f, 1e-6f);
  const auto linear = paper::paperCubic(0.0f, 0.0f, 4.0f, -1.0f);
  ASSERT_EQ(linear.count, 1);
  EXPECT_EQ(linear.t.x, 0.25f);
  EXPECT_EQ(paper::paperCubic(0.0f, 1.0f, 0.0f, 1.0f).count, 0);
  EXPECT_EQ(paper::paperCubic(0.0f, 0.0f, 0.0f, 1.0f).count, 0);
  EXPECT_EQ(paper::paperCubic(0.0f, 0.0f, 0.0f, 0.0f).count, 0);
}

TEST(Paper, MapIsTheInverseOfTheDeformation) {
  for (const auto& pose : test::kFigure6) {
    const PaperScene scene(solidBox({40, 64, 48}), pose);
    const Spline spline(test::inVoxels(scene.knots, static_cast<float>(scene.volume.size.y)));
    const dvec3 size(scene.volume.size);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    double sum = 0, sum_arcsine = 0;
    constexpr int kPoints = 5000;
    for (int i = 0; i < kPoints; ++i) {
      const dvec3 rest = size * dvec3(unit(random), 0.001 + 0.998 * unit(random), unit(random));
      const double t = spline.parameter(rest.y);
      const dvec3 s = spline.at(t);
      const glm::vec3 p(glm::dvec3(rest.x + s.x, rest.y, rest.z + s.z));
      const auto back = paper::paperMap(scene.context, paper::paperSpline(scene.context.segment), p);
      const auto shortcut =
          paper_arcsine::paperMap(scene.context, paper_arcsine::paperSpline(scene.context.segment), p);
      ASSERT_GE(back.t, 0.0f) << pose.name << " at t " << t;
      ASSERT_NEAR(back.t, t, 1e-4) << pose.name;
      ASSERT_NEAR(shortcut.t, t, 1e-4) << pose.name;
      sum += glm::length(dvec3(back.q) - rest) / kPoints;
      sum_arcsine += glm::length(dvec3(shortcut.q) - rest) / kPoints;
    }
    EXPECT_LT(sum, 1e-3) << pose.name;
    EXPECT_LT(sum_arcsine, 1e-3) << pose.name;
  }
}

TEST(Paper, EntryAndExitAreThoseOfTheDeformedBox) {
  for (const auto& pose : test::kFigure6) {
    const PaperScene scene(solidBox({40, 64, 48}), pose);
    PaperRays rays(scene);
    const reference::Volume box = scene.truth();
    int compared = 0, wrong_entry = 0, wrong_exit = 0, lost = 0;
    for (int i = 0; i < 2000; ++i) {
      const Ray ray = rays();
      const float far = 4 * glm::length(scene.bounds.max - scene.bounds.min);
      const auto entry = reference::firstTouch(box, scene.knots, dvec3(ray.o), dvec3(ray.r), 0, far, 0.0);
      if (!entry) continue;
      ++compared;
      const auto span =
          paper::paperEntryExit(scene.context, paper::paperSpline(scene.context.segment), ray.o, ray.r);
      if (span.entry > span.leave) {
        ++lost;
        continue;
      }
      wrong_entry += std::abs(double{span.entry} - entry->s) > 0.5;
      // The exit is the entry of the ray backwards.
      const dvec3 end = dvec3(ray.o) + double{far} * dvec3(ray.r);
      const auto leave = reference::firstTouch(box, scene.knots, end, -dvec3(ray.r), 0, far, 0.0);
      wrong_exit += !leave || std::abs(double{span.leave} - (double{far} - leave->s)) > 0.5;
    }
    EXPECT_GT(compared, 1900) << pose.name;
    EXPECT_LT(lost, 5) << pose.name;
    EXPECT_LT(wrong_entry, 10) << pose.name;
    EXPECT_LT(wrong_exit, 10) << pose.name;
  }
}

struct March {
  int owed = 0, missed = 0, invented = 0;
  double steps = 0;
  double missedShare() const { return static_cast<double>(missed) / owed; }
};

// march(context, o, r, s_max) -> PaperHit, judged as tests/bench does: at most a voxel behind the truth.
template <class Function>
March run(const PaperScene& scene, int count, Function&& march) {
  March result;
  PaperRays rays(scene);
  const reference::Volume truth = scene.truth();
  const float far = 4 * glm::length(scene.bounds.max - scene.bounds.min);
  for (int i = 0; i < count; ++i) {
    const Ray ray = rays();
    const paper::PaperHit hit = march(scene.context, ray.o, ray.r, far);
    const auto owed = reference::firstTouch(truth, scene.knots, dvec3(ray.o), dvec3(ray.r), 0, far, 0.01);
    result.steps += hit.steps / static_cast<double>(count);
    result.owed += owed.has_value();
    result.missed += owed && (!hit.found || double{hit.s} > owed->s + 1);
    if (!hit.found) continue;
    const auto possible =
        reference::firstTouch(truth, scene.knots, dvec3(ray.o), dvec3(ray.r), 0, far, -0.01);
    result.invented += !possible || double{hit.s} < possible->s - 1;
    EXPECT_TRUE(scene.volume.solid[scene.volume.index(hit.voxel)]);
  }
  return result;
}

TEST(Paper, ConstantStepsFindAlmostEveryHit) {
  for (const auto& pose : test::kFigure6) {
    const PaperScene scene(test::ballClump({96, 120, 72}, 24, 1), pose);
    const March all = run(scene, 500, [](const auto& c, auto o, auto r, float far) {
      return paper::paperStandard(c, o, r, 0.0f, far);
    });
    EXPECT_LT(all.missedShare(), 0.05) << pose.name;
    EXPECT_LE(all.invented, 5) << pose.name;
    EXPECT_GT(all.owed, 100) << pose.name;
    EXPECT_GT(all.steps, 50) << pose.name;
  }
}

TEST(Paper, DistanceFieldStepsLessAndSkipsSome) {
  March at_rest;
  int missed = 0, missed_world = 0, owed = 0;
  for (const auto& pose : test::kFigure6) {
    const PaperScene scene(test::ballClump({96, 120, 72}, 24, 1), pose);
    const auto constant = run(scene, 300, [](const auto& c, auto o, auto r, float far) {
      return paper::paperStandard(c, o, r, 0.0f, far);
    });
    const auto mapped = run(scene, 300, [](const auto& c, auto o, auto r, float far) {
      return paper::paperDistanceField(c, o, r, 0.0f, far, true);
    });
    const auto world = run(scene, 300, [](const auto& c, auto o, auto r, float far) {
      return paper::paperDistanceField(c, o, r, 0.0f, far, false);
    });
    EXPECT_LT(mapped.steps, 0.6 * constant.steps) << pose.name;
    EXPECT_LT(mapped.missedShare(), 0.35) << pose.name;
    owed += mapped.owed;
    missed += mapped.missed;
    missed_world += world.missed;
    if (pose.name == std::string("rest")) at_rest = mapped;
  }
  // Without deformation both are sphere tracing with a center-to-center distance, which is too long already;
  // bent, the heuristic errs too.
  EXPECT_LT(at_rest.steps, 15);
  EXPECT_LT(at_rest.missedShare(), 0.2);
  EXPECT_GT(missed, owed / 200);
  EXPECT_GT(missed_world, missed);
}

// Degrees between equation 5 and the exact transform, over random normals and heights.
double normalError(const glm::vec3& first, const glm::vec3& second, bool in_plane) {
  const Segment s = makeSegment({0, {0, 0, 0}, first}, {1, {0, 80, 0}, second}, 1);
  const trace::KelpSegment g{s.p0, s.m0, s.p1, s.m1};
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const float t = 0.02f + 0.96f * static_cast<float>(i) / 1000;
    const glm::vec3 n =
        glm::normalize(glm::vec3(normal(random), normal(random), in_plane ? 0.0f : normal(random)));
    const glm::vec3 exact = glm::normalize(trace::kelpDeformNormal(g, t, 1.0f, n));
    const glm::vec3 got = glm::normalize(paper::paperNormal(paper::paperSpline(g), t, n));
    worst = std::max(worst, static_cast<double>(glm::degrees(
                                std::atan2(glm::length(glm::cross(got, exact)), glm::dot(got, exact)))));
  }
  return worst;
}

TEST(Paper, NormalsAreRightInThePlaneOfOneBendOnly) {
  // bent in x, normals in the plane of x and y
  EXPECT_LT(normalError({240, 80, 0}, {-160, 80, 0}, true), 0.1);
  // the same bend, any normal: n_z is not shortened
  EXPECT_GT(normalError({240, 80, 0}, {-160, 80, 0}, false), 5.0);
  EXPECT_GT(normalError({240, 80, 80}, {240, 80, 160}, false), 5.0);  // two bent axes
  EXPECT_LT(normalError({0, 80, 0}, {0, 80, 0}, false), 0.1);         // none
}

}  // namespace
}  // namespace kelp

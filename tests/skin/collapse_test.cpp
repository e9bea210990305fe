// SPDX-License-Identifier: MIT
// Fits and their costs against sums over all moments, taken one by one.
#include "collapse.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "rigid.h"
#include "samples.h"
#include "skin_shapes.h"

namespace kelp::bake {
namespace {

struct Bent {
  test::SkinnedShape shape = test::tube(3);
  SkinSpace space = skinSpace(shape.frame);
  SkinSamples samples;
  SkinMoments moments;
  std::vector<std::uint32_t> members;  // every third sample

  Bent() {
    SourceSkin& skin = shape.skin();
    skin.clips.push_back(test::turningClip(
        skin, "bend", 2, 41, [](int j, double t) { return 0.5 * (j + 1) * std::sin(2.1 * t); }));
    samples = makeSkinSamples(shape.soup(), skin, space);
    moments = momentsAt(skin, 0, {0.1, 0.5, 0.77, 1.3, 1.9}, space, 1);
    for (std::uint32_t i = 0; i < samples.size(); i += 3) members.push_back(i);
  }
  double directCost(std::size_t i, const std::vector<glm::dmat4x3>& motions) const {
    double sum = 0;
    for (std::size_t t = 0; t < moments.size(); ++t) {
      const glm::dvec3 off =
          motions[t] * glm::dvec4(samples.positions[i], 1) - skinnedPoint(samples, i, moments, t);
      sum += glm::dot(off, off);
    }
    return sum / static_cast<double>(moments.size());
  }
};

TEST(SkinCollapse, CostsAreTheDirectSums) {
  const Bent bent;
  PartMotion motion(bent.samples, bent.moments, bent.members, 1);
  const std::vector<double> constants = constantCosts(bent.samples, bent.moments, 1);
  double most = 0;
  for (std::size_t i = 0; i < bent.samples.size(); ++i) {
    motion.prepareFor(i, bent.samples, bent.moments);
    const double direct = bent.directCost(i, motion.motions());
    most = std::max(most, direct);
    ASSERT_NEAR(motion.cost(i, bent.samples) + constants[i], direct, 1e-8 * (1 + direct)) << i;
  }
  EXPECT_GT(most, 10);  // there is something to compare
}

// The pull towards the joint is weak: no motion near the fitted one is better by more than a thousandth.
TEST(SkinCollapse, FitsAreTheBest) {
  const Bent bent;
  const auto energy = [&](const std::vector<glm::dmat4x3>& motions) {
    double sum = 0;
    for (const std::uint32_t i : bent.members) sum += bent.samples.areas[i] * bent.directCost(i, motions);
    return sum;
  };
  const std::vector<glm::dmat4x3> fitted = fitMotions(bent.samples, bent.moments, bent.members, 1);
  const double best = energy(fitted);
  for (int change = 0; change < 12; ++change) {
    const double step = change % 2 == 0 ? 0.02 : -0.02;
    std::vector<glm::dmat4x3> other = fitted;
    for (glm::dmat4x3& motion : other) {
      glm::dvec3 by(0);
      by[change / 2 % 3] = 1;
      if (change < 6) {
        motion[3] += 10 * step * by;
      } else {
        const glm::dvec3 middle = motion * glm::dvec4(0, 64, 0, 1);
        const glm::dmat3 turn(glm::rotate(glm::dmat4(1), step, by));
        motion = rigid(turn * linearOf(motion), turn * (motion[3] - middle) + middle);
      }
    }
    EXPECT_GT(energy(other), 0.999 * best) << change;
  }
  // A motion that is rigid is found: that of the samples which only one joint moves.
  std::vector<std::uint32_t> low;
  for (std::uint32_t i = 0; i < bent.samples.size(); ++i)
    if (bent.samples.weight(i, 0) == 1) low.push_back(i);
  ASSERT_GT(low.size(), 10u);
  const std::vector<glm::dmat4x3> rigid_fit = fitMotions(bent.samples, bent.moments, low, 2);
  for (std::size_t t = 0; t < bent.moments.size(); ++t)
    for (const std::uint32_t i : low)
      EXPECT_LT(glm::distance(rigid_fit[t] * glm::dvec4(bent.samples.positions[i], 1),
                              skinnedPoint(bent.samples, i, bent.moments, t)),
                0.6);
}

// Samples lie on the triangles, and their weighted points give the drawn triangles at every moment.
TEST(SkinSamples, AreTheDrawnTriangles) {
  const Bent bent;
  const SourceSkin& skin = bent.shape.skin();
  ASSERT_GT(bent.samples.size(), 2 * bent.shape.soup().positions.size());
  double area = 0;
  for (const TriangleSoup::Triangle& t : bent.shape.soup().triangles) {
    glm::dvec3 p[3];
    for (int c = 0; c < 3; ++c)
      p[c] = bent.space.from_soup *
             glm::dvec4(glm::dvec3(bent.shape.soup().positions[t.vertex[static_cast<std::size_t>(c)]]), 1);
    area += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  }
  EXPECT_NEAR(bent.samples.area, area, 1e-6 * area);
  EXPECT_NEAR(std::accumulate(bent.samples.areas.begin(), bent.samples.areas.end(), 0.0), area, 1e-6 * area);
  for (const SkinSamples::Edge& edge : bent.samples.edges)
    ASSERT_LE(glm::distance(bent.samples.positions[edge.a], bent.samples.positions[edge.b]), 3.0001);
  // The middle of an edge of the soup is drawn in the middle of its drawn ends.
  const auto drawn = [&](std::uint32_t vertex, std::size_t t) {
    glm::dvec3 at(0);
    const glm::dvec4 x =
        bent.space.from_soup * glm::dvec4(glm::dvec3(bent.shape.soup().positions[vertex]), 1);
    for (std::uint32_t k = skin.first_influence[vertex]; k < skin.first_influence[vertex + 1]; ++k)
      at += static_cast<double>(skin.influences[k].weight) *
            (bent.moments.motion(t, skin.influences[k].joint) * x);
    return at;
  };
  int compared = 0;
  for (const TriangleSoup::Triangle& t : bent.shape.soup().triangles) {
    const std::uint32_t a = t.vertex[0], b = t.vertex[1];
    const glm::dvec3 rest =
        bent.space.from_soup * glm::dvec4(0.5 * (glm::dvec3(bent.shape.soup().positions[a]) +
                                                 glm::dvec3(bent.shape.soup().positions[b])),
                                          1);
    for (std::size_t i = 0; i < bent.samples.size(); ++i) {
      if (glm::distance(bent.samples.positions[i], rest) > 1e-9) continue;
      for (std::size_t m = 0; m < bent.moments.size(); ++m)
        ASSERT_LT(
            glm::distance(skinnedPoint(bent.samples, i, bent.moments, m), 0.5 * (drawn(a, m) + drawn(b, m))),
            1e-4);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(SkinSamples, AreBoundedInNumber) {
  const test::SkinnedShape shape = test::tube(2, 101, 64);
  SourceSkin skin = shape.skin();
  for (const std::size_t most : {500u, 3000u, 20000u}) {
    const SkinSamples samples = makeSkinSamples(shape.soup(), skin, skinSpace(shape.frame), most);
    EXPECT_LE(samples.size(), most);
    EXPECT_GT(samples.size(), most / 12);
    EXPECT_GT(samples.triangles.size(), samples.size());
  }
}

}  // namespace
}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// A spline in double precision, and checks of bounds against it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "kelp/formats/spline.h"

namespace kelp::test {

// The Hermite basis in its textbook form, in double precision: independent of the coefficients the library
// makes.
struct SplineTruth {
  std::array<double, 3> p0, p1, m0, m1;

  SplineTruth(const Knot& k0, const Knot& k1) {
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
    return (6 * t * t - 6 * t) * (p0[i] - p1[i]) + (3 * t * t - 4 * t + 1) * m0[i] +
           (3 * t * t - 2 * t) * m1[i];
  }
};

inline Knot randomKnot(std::mt19937& random, float at, float reach) {
  std::uniform_real_distribution<float> any(-reach, reach);
  return {at, {any(random), any(random), any(random)}, {any(random), any(random), any(random)}};
}

// The exact range of a coordinate, from the roots of its derivative in long double.
inline std::pair<long double, long double> exactRange(const SplineTruth& r, int axis) {
  const long double rise = static_cast<long double>(r.p1[axis]) - r.p0[axis], m0 = r.m0[axis],
                    m1 = r.m1[axis];
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

// Every kind of size, turns that nearly are none, and double roots: the box contains the exact range, and
// exceeds it by roundings only.
inline void expectExactBounds(Box (*boundsOf)(std::span<const Knot>, const glm::ivec3&)) {
  std::mt19937 random(21);
  std::uniform_real_distribution<float> unit(-1, 1);
  const glm::ivec3 size(3, 1, 7);  // heights are voxels
  double worst = 0;
  int turning = 0;
  for (int n = 0; n < 200000; ++n) {
    const float scale = std::pow(10.0f, 3 * unit(random)), slope = scale * std::pow(10.0f, 2 * unit(random));
    std::vector<Knot> knots{randomKnot(random, 0, scale), randomKnot(random, 0.3f, scale),
                            randomKnot(random, 1, scale)};
    for (Knot& knot : knots) knot.tangent *= slope / scale;
    // the derivative nearly has a double root in the first segment: 12 (rise - m0) (rise - m1) .. 0
    if (n % 4 == 1) {
      const glm::vec3 rise = (knots[1].position - knots[0].position) / 0.3f;
      knots[0].tangent = rise * (1 + 1e-4f * unit(random));
      knots[1].tangent = rise * (4 + 1e-4f * unit(random));
    } else if (n % 4 == 2) {  // nearly no cubic term
      knots[1].tangent = 2.0f * (knots[1].position - knots[0].position) / 0.3f - knots[0].tangent +
                         1e-5f * slope * unit(random);
    } else if (n % 4 == 3) {  // flat ends
      knots[static_cast<std::size_t>(n / 4 % 3)].tangent = glm::vec3(0);
    }
    const Box box = boundsOf(knots, size);
    long double low[3] = {1e30L, 1e30L, 1e30L}, high[3] = {-1e30L, -1e30L, -1e30L};
    double sizes = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      // The segment as the library rounds it is the segment.
      const Segment s = makeSegment(knots[k], knots[k + 1], 1);
      SplineTruth r(knots[k], knots[k + 1]);
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
      worst = std::max({worst, static_cast<double>(low[i] - box.min[i]) / sizes,
                        static_cast<double>(box.max[i] - high[i] - base) / (sizes + 1)});
    }
  }
  EXPECT_GT(turning, 100000);
  EXPECT_LT(worst, 1e-4);
}

// Numbers whose squares overflow in float.
inline void expectBoundsOfHugeNumbers(Box (*boundsOf)(std::span<const Knot>, const glm::ivec3&)) {
  std::mt19937 random(22);
  for (int n = 0; n < 1000; ++n) {
    std::vector<Knot> knots{randomKnot(random, 0, 1e25f), randomKnot(random, 1, 1e25f)};
    const Box box = boundsOf(knots, {1, 1, 1});
    const SplineTruth r(knots[0], knots[1]);
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = exactRange(r, i);
      ASSERT_LE(box.min[i], low);
      ASSERT_GE(box.max[i], high);
      ASSERT_LT(box.max[i] - box.min[i], 1.001L * (high - low));
    }
  }
}

}  // namespace kelp::test

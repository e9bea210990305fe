// SPDX-License-Identifier: MIT
// Bounds that the runtime computes with SIMD, against the spline in double precision.
#include "kelp/simd/bound_knots.h"

#include "support/spline_truth.h"

namespace kelp::simd {
namespace {

TEST(BoundKnots, AreTheExactRangeUpToRounding) { test::expectExactBounds(&boundKnots); }
TEST(BoundKnots, HoldForHugeNumbers) { test::expectBoundsOfHugeNumbers(&boundKnots); }

// A bit is set only for a sound rig. Its bounds are then the exact range with the margin, whatever the other
// seven rigs are.
TEST(BoundKnots, EightRigsAtATime) {
  std::mt19937 random(24);
  std::uniform_real_distribution<float> unit(-1, 1);
  const float margin = 0.25f;
  const auto boundsOf = [&](const std::array<std::span<const Knot>, 8>& rigs, unsigned& sound) {
    std::span<const Knot> lanes[8];
    std::copy(rigs.begin(), rigs.end(), lanes);
    EightBoxes boxes;
    sound = boundKnots(lanes, EightFloats{{1, 1, 1, 1, 1, 1, 1, 1}}, margin, boxes);
    std::array<Box, 8> out;
    for (std::size_t rig = 0; rig < 8; ++rig) {
      for (int axis = 0; axis < 3; ++axis) {
        out[rig].min[axis] = boxes.min[axis].of[rig];
        out[rig].max[axis] = boxes.max[axis].of[rig];
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
    for (int i = 0; i <= last; ++i)
      knots.push_back(test::randomKnot(random, i == last ? 1.0f : 0.3f * static_cast<float>(i), scale));
    for (Knot& knot : knots) {
      knot.position.y = scale * (knot.at + 0.2f * knot.at * unit(random));
      knot.tangent = glm::vec3(knot.tangent.x * slope / scale, scale * (1.5f + 1.7f * unit(random)),
                               knot.tangent.z * slope / scale);
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
          const auto [least, most] = test::exactRange(test::SplineTruth(k0, k1), i);
          low = std::min(low, least);
          high = std::max(high, most);
          const long double share = k1.at - k0.at;
          sizes = std::max({sizes, std::abs(least), std::abs(most), share * std::abs(k0.tangent[i]),
                            share * std::abs(k1.tangent[i])});
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

}  // namespace
}  // namespace kelp::simd

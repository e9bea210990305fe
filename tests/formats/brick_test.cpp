// SPDX-License-Identifier: MIT
#include "kelp/formats/brick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace kelp {
namespace {

using Vector = std::array<double, 3>;

Vector randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  for (;;) {
    const Vector v{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (length > 1e-6) return {v[0] / length, v[1] / length, v[2] / length};
  }
}

double degreesBetween(const Vector& a, const glm::vec3& b) {
  const double dx = a[0] - b.x, dy = a[1] - b.y, dz = a[2] - b.z;
  return 2.0 * std::asin(0.5 * std::sqrt(dx * dx + dy * dy + dz * dz)) * 180.0 / std::numbers::pi;
}

// The decoder as SPEC.md states it, in double precision.
Vector decodeAsSpecified(int u, int v) {
  double x = (std::min(u, 4094) - 2047) / 2047.0, z = (std::min(v, 4094) - 2047) / 2047.0;
  const double y = 1 - std::abs(x) - std::abs(z), f = std::max(-y, 0.0);
  x -= x >= 0 ? f : -f;
  z -= z >= 0 ? f : -f;
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

TEST(Normal, AxesAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      glm::vec3 n(0.0f);
      n[axis] = sign;
      EXPECT_EQ(decodeNormal(encodeNormal(n)), n);
    }
  }
}

TEST(Normal, ErrorIsSmallInTheMeanAndAtWorst) {
  std::mt19937 random(1);
  double sum = 0, worst = 0;
  const int count = 200000;
  for (int i = 0; i < count; ++i) {
    const Vector d = randomDirection(random);
    const double error = degreesBetween(d, decodeNormal(encodeNormal(glm::vec3(d[0], d[1], d[2]))));
    sum += error;
    worst = std::max(worst, error);
  }
  RecordProperty("mean_degrees", std::to_string(sum / count));
  RecordProperty("worst_degrees", std::to_string(worst));
  std::printf("12 + 12 bits: mean %.5f degrees, worst %.5f degrees\n", sum / count, worst);
  // 2^24 points spread evenly over the sphere as a square lattice would leave 0.0190 degrees in the mean.
  EXPECT_LT(sum / count, 0.0205);
  EXPECT_LT(worst, 0.042);
}

TEST(Normal, EncodeFindsTheNearestOfAWideNeighborhood) {
  std::mt19937 random(2);
  for (int i = 0; i < 3000; ++i) {
    Vector d = randomDirection(random);
    if (i % 3 == 0) {  // near the folds and the axes, where the map is least even
      d[i % 9 / 3] *= 1e-4;
    }
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (double& c : d) c /= length;
    const std::uint32_t code = encodeNormal(glm::vec3(d[0], d[1], d[2]));
    const glm::vec3 input(d[0], d[1], d[2]);
    const auto chord = [&](const Vector& v) {
      return std::hypot(v[0] - input.x, v[1] - input.y, v[2] - input.z);
    };
    const int u0 = code & 0xfff, v0 = code >> 12;
    const double found = chord(decodeAsSpecified(u0, v0));
    for (int v = std::max(0, v0 - 6); v <= std::min(4095, v0 + 6); ++v) {
      for (int u = std::max(0, u0 - 6); u <= std::min(4095, u0 + 6); ++u) {
        ASSERT_LE(found, chord(decodeAsSpecified(u, v)) + 1e-7)
            << u0 << "," << v0 << " against " << u << "," << v;
      }
    }
  }
}

TEST(Normal, WithLowBitsOfOnesIsTheNearestOfAll) {
  std::mt19937 random(3);
  for (const int ones : {1, 3, 5, 8}) {
    for (int i = 0; i < 12; ++i) {
      Vector d = randomDirection(random);
      if (i % 3 == 0) d[i % 9 / 3] *= 1e-4;  // near the folds and the axes
      const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      for (double& c : d) c /= length;
      const std::uint32_t code = encodeNormal(glm::vec3(d[0], d[1], d[2]), ones);
      const std::uint32_t low = (1u << ones) - 1;
      EXPECT_EQ(code & low, low);
      EXPECT_EQ(code >> 12 & low, low);
      const auto chord = [&](const Vector& v) { return std::hypot(v[0] - d[0], v[1] - d[1], v[2] - d[2]); };
      const double found = chord(decodeAsSpecified(code & 0xfff, code >> 12));
      for (std::uint32_t v = low; v < 4096; v += low + 1)
        for (std::uint32_t u = low; u < 4096; u += low + 1)
          ASSERT_LE(found, chord(decodeAsSpecified(static_cast<int>(u), static_cast<int>(v))) + 1e-7) << ones;
    }
  }
}

TEST(Normal, DecodeFollowsTheSpecificationForEveryValue) {
  for (std::uint32_t bits = 0; bits < (1u << 24); bits += 97) {
    const Vector expected = decodeAsSpecified(bits & 0xfff, bits >> 12);
    const glm::vec3 n = decodeNormal(bits);
    for (int i = 0; i < 3; ++i) ASSERT_NEAR(n[i], expected[i], 1e-6) << bits;
  }
  EXPECT_EQ(decodeNormal(0xffffff), decodeNormal(0xffeffe));
}

TEST(Normal, SenselessInputGivesUp) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const glm::vec3& n :
       {glm::vec3(0.0f), glm::vec3(nan, 0, 0), glm::vec3(0, inf, 0), glm::vec3(-inf, nan, 1)}) {
    EXPECT_EQ(decodeNormal(encodeNormal(n)), glm::vec3(0, 1, 0));
  }
  // Length does not matter.
  EXPECT_EQ(encodeNormal({1e-30f, 2e-30f, -1e-30f}), encodeNormal({1e30f, 2e30f, -1e30f}));
}

TEST(Attribute, HoldsPaletteIndexAndNormal) {
  const std::uint32_t normal = encodeNormal({0.3f, -0.5f, 0.8f});
  const std::uint32_t attribute = makeAttribute(200, normal);
  EXPECT_EQ(attributePalette(attribute), 200);
  EXPECT_EQ(attributeNormal(attribute), normal);
}

TEST(EmptyBox, CodesHoldAReachForEachAxis) {
  EXPECT_EQ(codeReach(0), glm::ivec3(0));
  EXPECT_EQ(codeReach(63), glm::ivec3(7));
  EXPECT_EQ(codeReach(0b110110), glm::ivec3(3, 1, 7));
  const int reach[] = {0, 1, 3, 7};
  for (int code = 0; code < kSurfaceCode; ++code) {
    ASSERT_EQ(codeReach(static_cast<std::uint8_t>(code)),
              glm::ivec3(reach[code % 4], reach[code / 4 % 4], reach[code / 16]))
        << code;
  }
}

TEST(EmptyBox, CellsHoldAReachForEachSideAndTheClearance) {
  const std::uint32_t cell = 0x5b9c30f7;  // nibbles from the lowest: 7, 15, 0, 3, 12, 9
  const int reach[] = {7, 15, 0, 3, 12, 9};
  for (int side = 0; side < 6; ++side) EXPECT_EQ(cellReach(cell, side), reach[side]) << side;
  EXPECT_EQ(cellClearance(cell), 0x5b);
  for (int side = 0; side < 6; ++side) EXPECT_EQ(cellReach(0x7fffffff, side), kCellMaxReach);
  EXPECT_EQ(cellClearance(0x7fffffff), static_cast<int>(kCellMaxClearance));
  EXPECT_EQ(cellClearance(0x00ffffff), 0);
}

TEST(Level, SizesHalveUpward) {
  EXPECT_EQ(levelSize({100, 7, 1}, 0), glm::ivec3(100, 7, 1));
  EXPECT_EQ(levelSize({100, 7, 1}, 1), glm::ivec3(50, 4, 1));
  EXPECT_EQ(levelSize({100, 7, 1}, 3), glm::ivec3(13, 1, 1));
  EXPECT_EQ(levelSize({100, 7, 1}, 15), glm::ivec3(1, 1, 1));
  EXPECT_EQ(levelSize({2147483647, 7, 1}, 1).x, 1073741824);
  for (int n = 1; n < 300; ++n) {  // halving level by level is the same as dividing at once
    int side = n;
    for (int level = 0; level < kMaxLevels; ++level, side = (side + 1) / 2)
      EXPECT_EQ(levelSize({n, n, n}, level).y, side);
  }
  EXPECT_EQ(brickGrid({8, 9, 1}), glm::ivec3(1, 2, 1));
}

TEST(Morton, InterleavesBitsWithXLowest) {
  std::mt19937 random(3);
  for (int n = 0; n < 1000; ++n) {
    const glm::ivec3 p(random() & 0x1fffff, random() & 0x1fffff, random() & 0x1fffff);
    std::uint64_t expected = 0;
    for (int bit = 0; bit < 21; ++bit) {
      for (int axis = 0; axis < 3; ++axis)
        expected |= static_cast<std::uint64_t>((p[axis] >> bit) & 1) << (3 * bit + axis);
    }
    ASSERT_EQ(mortonCode(p), expected);
  }
}

TEST(SliceBase, CountsTheSurfaceVoxelsBeforeEachSlice) {
  std::mt19937 random(4);
  std::vector<std::uint8_t> codes(3 * kBrickVoxels);
  std::vector<std::uint32_t> expected;
  std::uint32_t total = 1000;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (i % 64 == 0) expected.push_back(total);
    const std::uint32_t rank = total - expected.back();
    switch (random() % 3) {
      case 0:
        codes[i] = static_cast<std::uint8_t>(random() % 64);
        break;
      case 1:
        codes[i] = kInnerCode;
        break;
      default:
        codes[i] = static_cast<std::uint8_t>(kSurfaceCode + rank);
        ++total;
    }
  }
  std::vector<std::uint32_t> base(24);
  EXPECT_EQ(computeSliceBase(codes, 1000, base).value(), total - 1000);
  EXPECT_EQ(base, expected);
}

TEST(SliceBase, RefusesReservedCodesAndWrongRanks) {
  std::vector<std::uint8_t> codes(kBrickVoxels, 0);
  std::vector<std::uint32_t> base(8);
  EXPECT_EQ(computeSliceBase(codes, 0, base).value(), 0u);
  for (int code = 129; code < 256; ++code) {
    codes[300] = static_cast<std::uint8_t>(code);
    EXPECT_FALSE(computeSliceBase(codes, 0, base)) << code;
  }
  codes[300] = kSurfaceCode + 1;
  EXPECT_FALSE(computeSliceBase(codes, 0, base));
  codes[300] = kSurfaceCode;
  EXPECT_EQ(computeSliceBase(codes, 0, base).value(), 1u);
  codes[301] = kSurfaceCode;  // the same rank twice
  EXPECT_FALSE(computeSliceBase(codes, 0, base));
  std::fill(codes.begin(), codes.end(), std::uint8_t{0});
  // a full slice has all 64 ranks
  for (int i = 0; i < 64; ++i) codes[64 + i] = static_cast<std::uint8_t>(kSurfaceCode + i);
  EXPECT_EQ(computeSliceBase(codes, 0, base).value(), 64u);
  EXPECT_FALSE(computeSliceBase(std::span(codes).first(511), 0, base));
  EXPECT_FALSE(computeSliceBase(codes, 0, std::span(base).first(7)));
}

}  // namespace
}  // namespace kelp

// SPDX-License-Identifier: MIT
// The rasterizer, against the question itself: whether some point a + s (b - a) + t (c - a) with s, t >= 0
// and s + t <= 1 lies in the closed cube. If any does, so does one where two of these nine bounds are
// reached, and there are 36 of those: solved as fractions of 128 bits, without rounding.
#include "kelp/voxelize/surface/touched_voxels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "kelp/common/dense_index.h"

namespace kelp::bake {
namespace {

__extension__ using Wide = __int128;

constexpr std::int64_t kUnit = std::int64_t{1} << kLatticeBits;
using Corners = std::array<glm::i64vec3, 3>;

// s a + t b <= c
struct Bound {
  Wide a, b, c;
};

bool haveCommonPoint(const Corners& corners, const glm::i64vec3& voxel) {
  std::vector<Bound> bounds{{-1, 0, 0}, {0, -1, 0}, {1, 1, 1}};
  for (int axis = 0; axis < 3; ++axis) {
    const Wide at = corners[0][axis], s = corners[1][axis] - corners[0][axis],
               t = corners[2][axis] - corners[0][axis], low = voxel[axis] * kUnit;
    bounds.push_back({-s, -t, at - low});
    bounds.push_back({s, t, low + kUnit - at});
  }
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    for (std::size_t k = i + 1; k < bounds.size(); ++k) {
      const Bound &p = bounds[i], &q = bounds[k];
      Wide whole = p.a * q.b - q.a * p.b, s = p.c * q.b - q.c * p.b, t = p.a * q.c - q.a * p.c;
      if (whole == 0) continue;
      if (whole < 0) {
        whole = -whole;
        s = -s;
        t = -t;
      }
      if (std::all_of(bounds.begin(), bounds.end(),
                      [&](const Bound& bound) { return bound.a * s + bound.b * t <= bound.c * whole; }))
        return true;
    }
  }
  return false;
}

Topology meshOf(const std::vector<Corners>& triangles) {
  Topology mesh;
  mesh.components.emplace_back();
  for (const Corners& corners : triangles) {
    SolidTriangle& t = mesh.triangles.emplace_back();
    t.source = static_cast<std::uint32_t>(mesh.triangles.size() - 1);
    for (std::size_t k = 0; k < 3; ++k) {
      t.vertex[k] = static_cast<std::uint32_t>(mesh.lattice.size());
      mesh.lattice.push_back(corners[k]);
    }
  }
  return mesh;
}

// Compares every voxel of the box, of each triangle alone.
void expectExact(const Corners& corners, const glm::ivec3& size) {
  const std::vector<std::uint64_t> touched = touchedVoxels(meshOf({corners}), size, 1);
  EXPECT_TRUE(std::is_sorted(touched.begin(), touched.end()));
  std::vector<std::uint64_t> expected;
  for (std::uint64_t i = 0; i < denseCount(size); ++i)
    if (haveCommonPoint(corners, glm::i64vec3(voxelAt(size, i)))) expected.push_back(i);
  ASSERT_EQ(touched, expected) << [&] {
    std::string text;
    for (const glm::i64vec3& p : corners)
      text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "; ";
    return text;
  }();
}

class TouchedVoxels : public testing::Test {
 protected:
  // Multiples of `step` from `low` to `high`.
  glm::i64vec3 place(std::int64_t low, std::int64_t high, std::int64_t step) {
    std::uniform_int_distribution<std::int64_t> its(low / step, high / step);
    return {its(random_) * step, its(random_) * step, its(random_) * step};
  }

  std::mt19937 random_{7};
};

TEST_F(TouchedVoxels, AreThoseOfAnyTriangle) {
  // Beyond the box too, to all sides.
  for (int i = 0; i < 300; ++i)
    expectExact({place(-3 * kUnit, 11 * kUnit, 1), place(-3 * kUnit, 11 * kUnit, 1),
                 place(-3 * kUnit, 11 * kUnit, 1)},
                glm::ivec3(8, 7, 9));
}

// Corners in a few places, mostly on the faces, edges and corners of voxels: planes along the grid, and along
// its diagonals, lines, points.
TEST_F(TouchedVoxels, AreThoseOfTrianglesThatLieOnTheGrid) {
  for (const std::int64_t step : {kUnit, kUnit / 2, kUnit / 3}) {
    for (int i = 0; i < 1500; ++i)
      expectExact({place(0, 4 * kUnit, step), place(0, 4 * kUnit, step), place(0, 4 * kUnit, step)},
                  glm::ivec3(4));
  }
}

// One step of the lattice off a plane of the grid, or off another triangle's side.
TEST_F(TouchedVoxels, AreThoseOfSliversAndOfTrianglesAStepOff) {
  for (int i = 0; i < 1500; ++i) {
    const glm::i64vec3 a = place(0, 5 * kUnit, kUnit), b = place(0, 5 * kUnit, kUnit);
    expectExact(
        {a + place(-1, 1, 1), b + place(-1, 1, 1), (i % 2 ? a : (a + b) / std::int64_t{2}) + place(-1, 1, 1)},
        glm::ivec3(5));
  }
}

TEST_F(TouchedVoxels, AreThoseOfLinesAndPoints) {
  for (int i = 0; i < 500; ++i) {
    const glm::i64vec3 a = place(-kUnit, 5 * kUnit, 1), step = place(-kUnit, kUnit, 1);
    expectExact({a, a + step, a + step * std::int64_t{3}}, glm::ivec3(5));
    expectExact({a + step, a, a + step}, glm::ivec3(5));
    expectExact({a, a, a}, glm::ivec3(5));
  }
}

// Above 32 voxels numbers no longer fit 64 bits. A slab of the box is compared, across them.
TEST_F(TouchedVoxels, AreThoseOfLargeTriangles) {
  for (const std::int64_t side : {33, 200, 8192}) {
    for (int i = 0; i < 40; ++i) {
      // Through the middle of the box's beginning.
      const glm::i64vec3 a = place(-kUnit, 8 * kUnit, 1), b = place(-side * kUnit, side * kUnit, 1);
      const glm::i64vec3 c = i % 4 == 0 ? a - b + place(-2, 2, 1) : place(-side * kUnit, side * kUnit, 1);
      expectExact({a, b, c}, glm::ivec3(8));
    }
  }
}

TEST_F(TouchedVoxels, AreThoseOfAllTrianglesThatAreNoCaps) {
  std::vector<Corners> triangles;
  for (int i = 0; i < 40; ++i) {
    const glm::i64vec3 a = place(-kUnit, 21 * kUnit, 1);
    triangles.push_back({a, a + place(-3 * kUnit, 3 * kUnit, 1), a + place(-9 * kUnit, 9 * kUnit, 1)});
  }
  Topology mesh = meshOf(triangles);
  mesh.triangles.back().source = kCap;
  mesh.caps = 1;
  const glm::ivec3 size(20, 21, 19);
  std::vector<std::uint64_t> expected, of_even;
  for (std::uint64_t i = 0; i < denseCount(size); ++i) {
    const auto touches = [&](std::size_t step) {
      for (std::size_t t = 0; t + 1 < triangles.size(); t += step)
        if (haveCommonPoint(triangles[t], glm::i64vec3(voxelAt(size, i)))) return true;
      return false;
    };
    if (touches(1)) expected.push_back(i);
    if (touches(2)) of_even.push_back(i);
  }
  for (const int threads : {1, 2, 7}) {
    EXPECT_EQ(touchedVoxels(mesh, size, threads), expected);
    EXPECT_EQ(touchedVoxels(mesh, size, threads, [](const SolidTriangle& t) { return t.source % 2 == 0; }),
              of_even);
  }
}

}  // namespace
}  // namespace kelp::bake

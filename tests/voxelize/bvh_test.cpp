// SPDX-License-Identifier: MIT
// Nearest points and first hits of the hierarchy, against every triangle looked at in turn.
#include "kelp/voxelize/surface/triangle_bvh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "truth.h"

namespace kelp::bake {
namespace {

// Triangles of all sizes within 32 voxels; some are lines, some points, some are there twice.
Topology randomMesh(int triangles, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int64_t> place(0, 32 << kLatticeBits);
  std::uniform_int_distribution<std::int64_t> size(-(3 << kLatticeBits), 3 << kLatticeBits);
  Topology mesh;
  mesh.components.emplace_back();
  for (int i = 0; i < triangles; ++i) {
    SolidTriangle t;
    t.source = static_cast<std::uint32_t>(i);
    const glm::i64vec3 corner(place(random), place(random), place(random));
    for (std::uint32_t& vertex : t.vertex) {
      vertex = static_cast<std::uint32_t>(mesh.lattice.size());
      mesh.lattice.push_back(corner + glm::i64vec3(size(random), size(random), size(random)));
    }
    if (i % 17 == 3) t.vertex[2] = t.vertex[1];
    if (i % 31 == 5) t.vertex[1] = t.vertex[2] = t.vertex[0];
    if (i % 13 == 7) t.vertex = mesh.triangles.back().vertex;
    mesh.triangles.push_back(t);
  }
  return mesh;
}

std::array<glm::dvec3, 3> cornersOf(const Topology& mesh, std::size_t i) {
  const auto& v = mesh.triangles[i].vertex;
  return {mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2])};
}

class Queries {
 public:
  glm::dvec3 point() { return {place_(random_), place_(random_), place_(random_)}; }
  int pick(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }

 private:
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> place_{-6, 38};
};

TEST(Bvh, FindsTheNearestOfAllTriangles) {
  // The last is far from the origin, where floats are coarser than the lattice.
  for (const auto& [count, away] : {std::pair(1, 0), {3, 0}, {5, 0}, {300, 0}, {300, 8100}}) {
    Topology mesh = randomMesh(count, 7);
    for (glm::i64vec3& vertex : mesh.lattice) vertex += glm::i64vec3(std::int64_t{away} << kLatticeBits);
    const TriangleBvh bvh(mesh);
    Queries queries;
    for (int round = 0; round < 500; ++round) {
      const glm::dvec3 p = queries.point() + static_cast<double>(away);
      const double bound = round % 3 ? 1e9 : 2.0;
      const std::uint32_t odd = round % 2;  // every other triangle, or all
      double least = bound;
      std::uint32_t expected = kCap;
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        glm::dvec3 weights;
        const double distance = test::distanceToTriangle(p, cornersOf(mesh, i), weights);
        if (i % 2 >= odd && distance < least - 1e-9) {
          least = distance;
          expected = i;
        }
      }
      const Nearest nearest = bvh.nearest(p, bound, [&](std::uint32_t i) { return i % 2 >= odd; });
      // Equal triangles: the first of them.
      ASSERT_EQ(nearest.triangle, expected) << "of " << count << ", round " << round;
      if (expected == kCap) continue;
      EXPECT_NEAR(std::sqrt(nearest.squared), least, 1e-9);
      EXPECT_NEAR(glm::distance(p, nearest.point), least, 1e-9);
      const auto [a, b, c] = cornersOf(mesh, nearest.triangle);
      EXPECT_NEAR(nearest.weights.x + nearest.weights.y + nearest.weights.z, 1, 1e-12);
      EXPECT_GE(std::min({nearest.weights.x, nearest.weights.y, nearest.weights.z}), -1e-12);
      EXPECT_LT(
          glm::distance(nearest.weights.x * a + nearest.weights.y * b + nearest.weights.z * c, nearest.point),
          1e-9);
    }
  }
}

// Queries that begin around a box, where it must hold what is near and may hold more; with guesses, bad ones
// too.
TEST(Bvh, FindsTheNearestOfThoseAroundABox) {
  for (const int count : {1, 2, 5, 30, 3000}) {
    const Topology mesh = randomMesh(count, 9);
    const TriangleBvh bvh(mesh, 3);
    Queries queries;
    int found = 0, nothing = 0;
    for (int round = 0; round < 400; ++round) {
      const double reach = round % 2 ? 0.5 : 3.0;
      const glm::dvec3 low = queries.point(), high = low + glm::dvec3(round % 8, round % 5, 7);
      const TriangleBvh::Around around = bvh.around(low, high, reach);
      for (const double share : {0.0, 0.3, 1.0}) {
        const glm::dvec3 p = glm::mix(low, high, share);
        Nearest guess;
        guess.squared = reach * reach;
        const std::uint32_t triangle = static_cast<std::uint32_t>(queries.pick(count));
        glm::dvec3 weights;
        const auto [a, b, c] = cornersOf(mesh, triangle);
        const glm::dvec3 q = nearestOnTriangle(p, a, b, c, weights);
        if (glm::dot(p - q, p - q) < guess.squared) guess = {triangle, glm::dot(p - q, p - q), q, weights};
        // The other query's answer: the test above compares that with all triangles.
        const Nearest expected = bvh.nearest(p, reach), nearest = bvh.nearest(around, p, guess);
        ASSERT_EQ(nearest.triangle, expected.triangle) << count << " " << round;
        if (expected.triangle == kCap) {
          ++nothing;
          continue;
        }
        ++found;
        EXPECT_EQ(nearest.squared, expected.squared);
        EXPECT_EQ(nearest.point, expected.point);
        EXPECT_EQ(nearest.weights, expected.weights);
      }
      const glm::dvec3 p = glm::mix(low, high, 0.5);
      const int axis = queries.pick(3), sign = queries.pick(2) ? 1 : -1;
      const auto any = [](const Nearest&) { return true; };
      EXPECT_EQ(bvh.first(around, p, axis, sign, reach, any).triangle,
                bvh.first(p, axis, sign, reach, any).triangle);
    }
    EXPECT_GT(count > 1000 ? found : nothing, 100);
  }
}

// Where a way along an axis meets a triangle: Moeller and Trumbore's test, in doubles. -1: nowhere.
double meets(const glm::dvec3& p, const glm::dvec3& way, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 ab = t[1] - t[0], ac = t[2] - t[0], across = glm::cross(way, ac);
  const double determinant = glm::dot(ab, across);
  if (determinant == 0) return -1;
  const glm::dvec3 from = p - t[0], other = glm::cross(from, ab);
  const double u = glm::dot(from, across) / determinant, v = glm::dot(way, other) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 ? glm::dot(ac, other) / determinant : -1;
}

TEST(Bvh, FindsTheFirstTriangleOnAWay) {
  const Topology mesh = randomMesh(400, 11);
  const TriangleBvh bvh(mesh);
  Queries queries;
  int met = 0;
  for (int round = 0; round < 6000; ++round) {
    const glm::dvec3 p = queries.point();
    const int axis = queries.pick(3), sign = queries.pick(2) ? 1 : -1;
    glm::dvec3 way(0);
    way[axis] = sign;
    double least = round % 2 ? 4.0 : 100.0;
    const double length = least;
    std::uint32_t expected = kCap;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const double at = i % 3 ? meets(p, way, cornersOf(mesh, i)) : -1;
      if (at < 0 || at >= least - 1e-9) continue;
      least = at;
      expected = i;
    }
    const Nearest hit =
        bvh.first(p, axis, sign, length, [](const Nearest& nearest) { return nearest.triangle % 3 != 0; });
    ASSERT_EQ(hit.triangle, expected) << round;
    if (expected == kCap) continue;
    ++met;
    EXPECT_NEAR(std::sqrt(hit.squared), least, 1e-6);
    EXPECT_LT(glm::distance(hit.point, p + least * way), 1e-6);
    const auto [a, b, c] = cornersOf(mesh, hit.triangle);
    EXPECT_LT(glm::distance(hit.weights.x * a + hit.weights.y * b + hit.weights.z * c, hit.point), 1e-6);
  }
  EXPECT_GT(met, 300);
}

// A square of two triangles, looked at through its corners, its diagonal and its sides: no way slips between
// them, and both have the same distance, so the first of them answers.
TEST(Bvh, NoWaySlipsThroughASharedSide) {
  Topology mesh;
  mesh.components.emplace_back();
  for (const glm::i64vec3& p : {glm::i64vec3(0, 0, 5), {8, 0, 5}, {8, 8, 5}, {0, 8, 5}})
    mesh.lattice.push_back(p * (std::int64_t{1} << kLatticeBits));
  mesh.triangles.resize(2);
  mesh.triangles[0].vertex = {0, 1, 2};
  mesh.triangles[1].vertex = {0, 2, 3};
  const TriangleBvh bvh(mesh);
  const auto any = [](const Nearest&) { return true; };
  for (int y = 0; y <= 8; ++y) {
    for (int x = 0; x <= 8; ++x) {
      const Nearest hit = bvh.first(glm::dvec3(x, y, 0), 2, 1, 10, any);
      EXPECT_EQ(hit.triangle, x >= y ? 0u : 1u);
      EXPECT_EQ(hit.squared, 25);
      EXPECT_EQ(bvh.first(glm::dvec3(x, y, 0), 2, -1, 10, any).triangle, kCap);
      EXPECT_EQ(bvh.first(glm::dvec3(x, y, 0), 2, 1, 4.9, any).triangle, kCap);
      EXPECT_EQ(bvh.nearest(glm::dvec3(x, y, 0)).triangle, x >= y ? 0u : 1u);
    }
  }
}

}  // namespace
}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Discs of triangles across polygons, against what is true of any: area, topology, Delaunay's rule.
#include "patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "plain_patch.h"

namespace kelp::bake {
namespace {

glm::dvec3 areaOf(const PlainPatch& patch, std::size_t t) {
  const auto& [a, b, c] = patch.triangles[t];
  return 0.5 * glm::cross(patch.points[b] - patch.points[a], patch.points[c] - patch.points[a]);
}
double totalArea(const PlainPatch& patch) {
  double area = 0;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) area += glm::length(areaOf(patch, t));
  return area;
}

std::vector<glm::dvec3> circle(int corners, double radius) {
  std::vector<glm::dvec3> polygon;
  for (int i = 0; i < corners; ++i)
    polygon.emplace_back(radius * std::cos(2 * std::numbers::pi * i / corners),
                         radius * std::sin(2 * std::numbers::pi * i / corners), 0);
  return polygon;
}
// A polygon through these corners, with points about every `step` along its edges.
std::vector<glm::dvec3> along(const std::vector<glm::dvec2>& corners, double step) {
  std::vector<glm::dvec3> polygon;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 from = corners[i], to = corners[(i + 1) % corners.size()];
    const int count = std::max(1, static_cast<int>(std::round(glm::distance(from, to) / step)));
    for (int k = 0; k < count; ++k) polygon.emplace_back(glm::mix(from, to, double(k) / count), 0);
  }
  return polygon;
}
// A comb with two gaps: a fan over it, or the longest diagonals, would leave it.
std::vector<glm::dvec3> comb() {
  return along({{0, 0},
                {20, 0},
                {20, 10},
                {16, 10},
                {16, 3},
                {12, 3},
                {12, 10},
                {8, 10},
                {8, 3},
                {4, 3},
                {4, 10},
                {0, 10}},
               1);
}
double shoelace(const std::vector<glm::dvec3>& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const glm::dvec3 &a = p[i], &b = p[(i + 1) % p.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

// In its plane a polygon has one area, whatever its triangles are, and every triangle faces the same way.
// Only a triangulation that leaves the polygon, or covers a place twice, has more.
TEST(Patch, CoversAFlatPolygonOnce) {
  for (const std::vector<glm::dvec3>& polygon : {circle(48, 10), comb()}) {
    const PlainPatch patch(spanPolygon(polygon));
    EXPECT_NEAR(totalArea(patch), shoelace(polygon), 1e-9);
    for (std::size_t t = 0; t < patch.triangles.size(); ++t) EXPECT_GT(areaOf(patch, t).z, 0);
  }
}

// Every side lies between two triangles that run along it in opposite senses, or is an edge of the polygon;
// and V - E + F = 1.
TEST(Patch, IsADisc) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-1, 1);
  std::vector<glm::dvec3> jagged = circle(40, 10);
  for (glm::dvec3& p : jagged) p += glm::dvec3(noise(random), noise(random), 3 * noise(random));
  for (const std::vector<glm::dvec3>& polygon :
       {circle(3, 1), circle(4, 5), circle(64, 10), comb(), jagged}) {
    const PlainPatch patch(spanPolygon(polygon));
    ASSERT_EQ(patch.rim, polygon.size());
    EXPECT_TRUE(std::equal(polygon.begin(), polygon.end(), patch.points.begin()));
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const auto& t : patch.triangles) {
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(++sides[std::pair(t[k], t[(k + 1) % 3])], 1);
    }
    std::size_t open = 0;
    for (const auto& [side, count] : sides) {
      if (sides.count({side.second, side.first})) continue;
      ++open;
      EXPECT_EQ(side.second, (side.first + 1) % patch.rim);
    }
    EXPECT_EQ(open, polygon.size());
    const std::size_t edges = (sides.size() + open) / 2;
    EXPECT_EQ(patch.points.size() + patch.triangles.size(), edges + 1);
  }
}

// No corner lies in the circle around another triangle: brute force over all of both.
TEST(Patch, IsADelaunayTriangulationOfAConvexPolygon) {
  const PlainPatch patch(spanPolygon(circle(48, 10)));
  for (const auto& t : patch.triangles) {
    const glm::dvec2 a(patch.points[t[0]]), b(patch.points[t[1]]), c(patch.points[t[2]]);
    const double d = 2 * (a.x * (b.y - c.y) + b.x * (c.y - a.y) + c.x * (a.y - b.y));
    const double aa = glm::dot(a, a), bb = glm::dot(b, b), cc = glm::dot(c, c);
    const glm::dvec2 centre((aa * (b.y - c.y) + bb * (c.y - a.y) + cc * (a.y - b.y)) / d,
                            (aa * (c.x - b.x) + bb * (a.x - c.x) + cc * (b.x - a.x)) / d);
    const double radius = glm::distance(centre, a);
    for (const glm::dvec3& p : patch.points)
      EXPECT_GT(glm::distance(centre, glm::dvec2(p)), radius * (1 - 1e-3));
  }
}

// Triangles are about as small as the polygon's edges: none is left whose middle is far from its corners. A
// disc of n edges of length 1 has an area of n^2 / (4 pi). Equilateral triangles with sides of 1 fill it with
// as many as its area / (sqrt(3) / 4); Euler's formula tells the points from the triangles and the rim.
TEST(Patch, IsRefinedToTheLengthOfThePolygonsEdges) {
  for (const int corners : {24, 48, 64}) {
    const PlainPatch patch(spanPolygon(circle(corners, corners / (2 * std::numbers::pi))));
    for (const auto& [a, b, c] : patch.triangles) {
      const glm::dvec3 centre = (patch.points[a] + patch.points[b] + patch.points[c]) / 3.0;
      EXPECT_LT(std::min({glm::distance(centre, patch.points[a]), glm::distance(centre, patch.points[b]),
                          glm::distance(centre, patch.points[c])}),
                0.7072);
    }
    const double area = corners * corners / (4 * std::numbers::pi);
    const double expected = 0.5 * area / (0.25 * std::numbers::sqrt3) + 0.5 * corners + 1;
    EXPECT_NEAR(static_cast<double>(patch.points.size()), expected, 0.2 * expected);
  }
}

// The least area of all triangulations of a polygon in space, by trying all. Small polygons get no points
// within, and turned edges alone can make the patch larger again: by little.
double leastArea(const std::vector<glm::dvec3>& p, std::size_t from, std::size_t to) {
  if (to - from < 2) return 0;
  double least = 1e300;
  for (std::size_t k = from + 1; k < to; ++k)
    least = std::min(least, leastArea(p, from, k) + leastArea(p, k, to) +
                                0.5 * glm::length(glm::cross(p[k] - p[from], p[to] - p[from])));
  return least;
}
TEST(Patch, HasNearlyTheLeastAreaInSpace) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-1, 1);
  for (int round = 0; round < 20; ++round) {
    std::vector<glm::dvec3> polygon = circle(9, 2);
    for (glm::dvec3& p : polygon) p.z = noise(random);
    const PlainPatch patch(spanPolygon(polygon));
    const double least = leastArea(polygon, 0, polygon.size() - 1);
    EXPECT_LT(totalArea(patch), 1.1 * least);
  }
}

}  // namespace
}  // namespace kelp::bake

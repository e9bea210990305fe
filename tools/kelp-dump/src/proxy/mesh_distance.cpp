// SPDX-License-Identifier: MIT
#include "proxy/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kelp::dump {
namespace {

constexpr std::size_t kLeaf = 4;

// Christer Ericson, Real-Time Collision Detection, section 5.1.5. A degenerate triangle is the edges that it
// has.
double squaredDistance(const glm::dvec3& p, const Triangle& t) {
  const auto toEdge = [&](const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 along = to - from;
    const double length = glm::dot(along, along);
    const double at = length > 0 ? glm::clamp(glm::dot(p - from, along) / length, 0.0, 1.0) : 0.0;
    const glm::dvec3 apart = p - (from + at * along);
    return glm::dot(apart, apart);
  };
  const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
  const double area = glm::dot(normal, normal);
  if (area > 0 && glm::dot(glm::cross(t.c - t.b, p - t.b), normal) >= 0 &&
      glm::dot(glm::cross(t.a - t.c, p - t.c), normal) >= 0 &&
      glm::dot(glm::cross(t.b - t.a, p - t.a), normal) >= 0) {
    const double height = glm::dot(p - t.a, normal);
    return height * height / area;
  }
  return std::min({toEdge(t.a, t.b), toEdge(t.b, t.c), toEdge(t.c, t.a)});
}

// The distance to one triangle is convex, so it is largest at a corner. A distance grows by no more than the
// way, so no point of a triangle is farther away than its middle and its radius together. A triangle that may
// exceed what was found so far is cut in two at its longest edge.
void findLargest(const Triangle& t, const TriangleTree& to, double tolerance, double& found) {
  const glm::dvec3 middle = (t.a + t.b + t.c) / 3.0;
  const TriangleTree::Nearest nearest = to.nearest(middle);
  const double distance = std::sqrt(nearest.squared);
  found = std::max(found, distance);
  const double bound = found + tolerance, squared = bound * bound;
  const double radius =
      std::max({glm::distance(middle, t.a), glm::distance(middle, t.b), glm::distance(middle, t.c)});
  if (distance + radius <= bound) return;
  if (squaredDistance(t.a, *nearest.triangle) <= squared &&
      squaredDistance(t.b, *nearest.triangle) <= squared &&
      squaredDistance(t.c, *nearest.triangle) <= squared)
    return;
  const double ab = glm::distance(t.a, t.b), bc = glm::distance(t.b, t.c), ca = glm::distance(t.c, t.a);
  const auto [a, b, c] = ab >= bc && ab >= ca ? t
                         : bc >= ca           ? Triangle{t.b, t.c, t.a}
                                              : Triangle{t.c, t.a, t.b};
  const glm::dvec3 cut = (a + b) * 0.5;
  findLargest({a, cut, c}, to, tolerance, found);
  findLargest({cut, b, c}, to, tolerance, found);
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  nodes_.reserve(2 * (triangles_.size() / kLeaf + 1));
  build(0, triangles_.size());
}

// Halves by the median of the corners' sums along the longest axis: at most 32 levels.
void TriangleTree::build(std::size_t begin, std::size_t end) {
  const std::size_t at = nodes_.size();
  glm::dvec3 low = triangles_[begin].a, high = low;
  for (std::size_t i = begin; i < end; ++i)
    for (const glm::dvec3& p : {triangles_[i].a, triangles_[i].b, triangles_[i].c})
      low = glm::min(low, p), high = glm::max(high, p);
  nodes_.push_back({low, high, begin, end - begin});
  if (end - begin <= kLeaf) return;
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t half = begin + (end - begin) / 2;
  const auto place = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(place(begin), place(half), place(end), [&](const Triangle& s, const Triangle& t) {
    return s.a[axis] + s.b[axis] + s.c[axis] < t.a[axis] + t.b[axis] + t.c[axis];
  });
  build(begin, half);
  nodes_[at].first = nodes_.size();
  nodes_[at].count = 0;
  build(half, end);
}

double TriangleTree::squaredDistance(const glm::dvec3& p, const Node& node) {
  const glm::dvec3 apart = p - glm::clamp(p, node.low, node.high);
  return glm::dot(apart, apart);
}

TriangleTree::Nearest TriangleTree::nearest(const glm::dvec3& p) const {
  Nearest found{std::numeric_limits<double>::max(), triangles_.data()};
  std::pair<std::size_t, double> stack[64] = {{0, 0.0}};  // a node and its squared distance
  for (int waiting = 1; waiting > 0;) {
    const auto [index, squared] = stack[--waiting];
    if (squared >= found.squared) continue;
    const Node& node = nodes_[index];
    for (std::size_t i = node.first; i < node.first + node.count; ++i)
      if (const double d = dump::squaredDistance(p, triangles_[i]); d < found.squared)
        found = {d, &triangles_[i]};
    if (node.count > 0) continue;
    std::pair near{index + 1, squaredDistance(p, nodes_[index + 1])};
    std::pair far{node.first, squaredDistance(p, nodes_[node.first])};
    if (far.second < near.second) std::swap(near, far);
    stack[waiting++] = far;
    stack[waiting++] = near;
  }
  return found;
}

double largestDistance(const std::vector<Triangle>& triangles, const TriangleTree& to, double tolerance) {
  double found = 0;
  for (const Triangle& triangle : triangles) findLargest(triangle, to, tolerance, found);
  return found + tolerance;
}

}  // namespace kelp::dump

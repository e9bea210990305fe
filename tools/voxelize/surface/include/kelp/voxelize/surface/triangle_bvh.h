// SPDX-License-Identifier: MIT
// The nearest point of a mesh, and the first hit along an axis. Answers depend only on the mesh and the
// query.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

struct Nearest {
  std::uint32_t triangle = kCap;  // index into Topology::triangles; kCap: none within the bound
  double squared = std::numeric_limits<double>::infinity();
  glm::dvec3 point{0};
  glm::dvec3 weights{1, 0, 0};  // barycentric
};

// A hierarchy of boxes over the triangles. Immutable once made; queries may run on any thread.
class TriangleBvh {
 public:
  // Over all triangles of `mesh`, caps too.
  explicit TriangleBvh(const Topology& mesh);

  // The nearest triangle within `bound` voxels of p; of several at the same distance the one with the lowest
  // index.
  Nearest nearest(const glm::dvec3& p, double bound = std::numeric_limits<double>::infinity()) const {
    return nearest(p, bound, [](std::uint32_t) { return true; });
  }
  // The same among the triangles that `accept(index)` lets pass.
  template <class Accept>
  Nearest nearest(const glm::dvec3& p, double bound, const Accept& accept) const;

  // The first triangle that `accept(hit)`, of a Nearest, lets pass on the way from p along `axis` (0 to 2),
  // towards its end (`sign` 1) or its beginning
  // (-1), within `length` voxels; of several at the same distance the one with the lowest index. kCap: none.
  // `squared` is that of the way.
  template <class Accept>
  Nearest first(const glm::dvec3& p, int axis, int sign, double length, const Accept& accept) const;

 private:
  struct Node {
    glm::vec3 low, high;
    std::uint32_t first = 0;  // first of `count` entries in order_, or of two adjacent children
    std::uint32_t count = 0;  // 0: inner node
  };

  static double squaredToBox(const glm::dvec3& p, const Node& node) {
    const glm::dvec3 outside =
        glm::max(glm::max(glm::dvec3(node.low) - p, p - glm::dvec3(node.high)), glm::dvec3(0));
    return glm::dot(outside, outside);
  }

  // Copied corners, leaf by leaf: a query that reaches a leaf reads one stretch of memory.
  struct Corners {
    glm::dvec3 a, b, c;
  };

  std::vector<std::uint32_t> order_;
  std::vector<Corners> corners_;  // of order_
  std::vector<Node> nodes_;
};

// The point of triangle abc nearest to p and its barycentric weights.
// Source: Ericson, "Real-Time Collision Detection", section 5.1.5.
glm::dvec3 nearestOnTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                             const glm::dvec3& c, glm::dvec3& weights);

template <class Accept>
Nearest TriangleBvh::nearest(const glm::dvec3& p, double bound, const Accept& accept) const {
  Nearest best;
  best.squared = bound * bound;
  struct Entry {
    std::uint32_t node;
    double squared;
  };
  Entry stack[128];
  int top = 0;
  stack[top++] = {0, squaredToBox(p, nodes_[0])};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.squared > best.squared) continue;
    const Node& node = nodes_[entry.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (!accept(order_[i])) continue;
        glm::dvec3 weights;
        const glm::dvec3 q = nearestOnTriangle(p, corners_[i].a, corners_[i].b, corners_[i].c, weights);
        const double squared = glm::dot(p - q, p - q);
        if (squared < best.squared || (squared == best.squared && order_[i] < best.triangle))
          best = {order_[i], squared, q, weights};
      }
      continue;
    }
    Entry near{node.first, squaredToBox(p, nodes_[node.first])};
    Entry far{node.first + 1, squaredToBox(p, nodes_[node.first + 1])};
    if (far.squared < near.squared) std::swap(near, far);
    // The tree is balanced: its depth, hence the stack, is some 32 for any mesh that has 32-bit indices.
    if (far.squared <= best.squared) stack[top++] = far;
    if (near.squared <= best.squared) stack[top++] = near;
  }
  return best;
}

template <class Accept>
Nearest TriangleBvh::first(const glm::dvec3& p, int axis, int sign, double length,
                           const Accept& accept) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Nearest best;
  double way = length;
  struct Entry {
    std::uint32_t node;
    double near;
  };
  Entry stack[128];
  int top = 0;
  const auto push = [&](const Entry& entry) {
    const Node& node = nodes_[entry.node];
    const double far = sign > 0 ? static_cast<double>(node.high[axis]) - p[axis]
                                : p[axis] - static_cast<double>(node.low[axis]);
    if (entry.near <= way && far >= 0 && p[u] >= node.low[u] && p[u] <= node.high[u] && p[v] >= node.low[v] &&
        p[v] <= node.high[v])
      stack[top++] = entry;
  };
  const auto entryOf = [&](std::uint32_t node) {
    return Entry{node, sign > 0 ? static_cast<double>(nodes_[node].low[axis]) - p[axis]
                                : p[axis] - static_cast<double>(nodes_[node].high[axis])};
  };
  push(entryOf(0));
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.near > way) continue;
    const Node& node = nodes_[entry.node];
    if (node.count == 0) {
      Entry near = entryOf(node.first), far = entryOf(node.first + 1);
      if (far.near < near.near) std::swap(near, far);
      push(far);
      push(near);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Corners& t = corners_[i];
      // Twice the areas of the three triangles that p makes with the sides, as seen along the axis.
      const auto area = [&](const glm::dvec3& a, const glm::dvec3& b) {
        return (a[u] - p[u]) * (b[v] - p[v]) - (a[v] - p[v]) * (b[u] - p[u]);
      };
      const double a = area(t.b, t.c), b = area(t.c, t.a), c = area(t.a, t.b), sum = a + b + c;
      if (sum == 0 || (sum > 0 ? std::min({a, b, c}) < 0 : std::max({a, b, c}) > 0)) continue;
      const double at = (a * t.a[axis] + b * t.b[axis] + c * t.c[axis]) / sum,
                   distance = (at - p[axis]) * sign;
      if (distance < 0 || distance > way ||
          (distance == way && best.triangle != kCap && order_[i] > best.triangle))
        continue;
      Nearest hit{order_[i], distance * distance, p, glm::dvec3(a, b, c) / sum};
      hit.point[axis] = at;
      if (!accept(hit)) continue;
      way = distance;
      best = hit;
    }
  }
  return best;
}

}  // namespace kelp::bake

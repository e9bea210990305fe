// SPDX-License-Identifier: MIT
// The nearest point of a mesh, and the first hit along an axis. Answers depend only on the mesh and the
// query.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

struct Nearest {
  std::uint32_t triangle = kCap;  // index into Topology::triangles; kCap: none within the bound
  double squared = std::numeric_limits<double>::infinity();
  glm::dvec3 point{0};
  glm::dvec3 weights{1, 0, 0};  // barycentric
};

// A hierarchy of boxes over the triangles, four at a time. Immutable once made; queries may run on any
// thread.
class TriangleBvh {
 public:
  // The triangles within some distance of a box, and perhaps others: for queries near it, which need not
  // begin at the top of the hierarchy each time.
  class Around;

  // Over all triangles of `mesh`, caps too.
  explicit TriangleBvh(const Topology& mesh, int threads = 1);

  // The nearest triangle within `bound` voxels of p; of several at the same distance the one with the lowest
  // index.
  Nearest nearest(const glm::dvec3& p, double bound = std::numeric_limits<double>::infinity()) const {
    return nearest(p, bound, [](std::uint32_t) { return true; });
  }
  // The same among the triangles that `accept(index)` lets pass.
  template <class Accept>
  Nearest nearest(const glm::dvec3& p, double bound, const Accept& accept) const;

  Around around(const glm::dvec3& low, const glm::dvec3& high, double distance) const;
  // The nearest triangle of those around, or `guess`, which is one at its place nearest to p, or holds a
  // bound for `squared`. Where that is no more than the distance of `around` from p's box, no other is
  // nearer.
  Nearest nearest(const Around& around, const glm::dvec3& p, Nearest guess) const;

  // The first triangle that `accept(hit)`, of a Nearest, lets pass on the way from p along `axis` (0 to 2),
  // towards its end (`sign` 1) or its beginning (-1), within `length` voxels; of several at the same distance
  // the one with the lowest index. kCap: none. `squared` is that of the way. The way must be within the
  // distance of `around`.
  template <class Accept>
  Nearest first(const Around& around, const glm::dvec3& p, int axis, int sign, double length,
                const Accept& accept) const;
  template <class Accept>
  Nearest first(const glm::dvec3& p, int axis, int sign, double length, const Accept& accept) const;

 private:
  // Four numbers, and as many answers of a comparison, 0 or -1. GCC and Clang have these types everywhere.
  using Floats = float __attribute__((vector_size(16)));
  using Answers = std::int32_t __attribute__((vector_size(16)));
  static Floats all(double x) {
    const float its = static_cast<float>(x);
    return Floats{its, its, its, its};
  }
  static Floats larger(Floats a, Floats b) { return a > b ? a : b; }

  // A child is a node, or with kLeaf the place of a triangle in order_; kNothing: there is none.
  static constexpr std::uint32_t kLeaf = 0x80000000u, kNothing = 0xffffffffu;
  // The boxes are larger than what they hold by more than rounding makes of a point, and of a difference.
  struct Node {
    Floats low[3], high[3];
    std::uint32_t child[4];

    // Below the squared distances of p from what the boxes hold.
    Floats squaredTo(const Floats (&p)[3]) const {
      Floats sum{};
      for (int axis = 0; axis < 3; ++axis) {
        const Floats outside = larger(larger(low[axis] - p[axis], p[axis] - high[axis]), Floats{});
        sum += outside * outside;
      }
      return sum * (1 - 1.0f / (1 << 18));
    }
  };
  // Copied corners, in the order of the boxes.
  struct Corners {
    glm::dvec3 a, b, c;
  };

  struct Entry {
    std::uint32_t node;
    double squared;
  };
  // The tree is balanced, four children each: 16 levels hold any mesh that has 31-bit indices.
  static constexpr int kStack = 128;

  class Builder;

  // Looks into a node's children for what is nearer than `best`; puts those that are nodes on the stack, the
  // nearest last.
  template <class Accept>
  void look(const Node& node, const glm::dvec3& p, const Floats (&place)[3], const Accept& accept,
            Entry (&stack)[kStack], int& top, Nearest& best) const;
  template <class Accept>
  void search(const Node* nodes, int count, const glm::dvec3& p, const Accept& accept, Nearest& best) const;
  template <class Accept>
  Nearest first(const Node* nodes, int count, const glm::dvec3& p, int axis, int sign, double length,
                const Accept& accept) const;
  // Finds where a line through p along an axis meets a triangle: false if it does not.
  static bool meets(const Corners& triangle, const glm::dvec3& p, int axis, Nearest& hit);

  std::vector<std::uint32_t> order_;
  std::vector<Corners> corners_;  // of order_
  std::vector<Node> nodes_;
};

class TriangleBvh::Around {
 private:
  friend class TriangleBvh;
  static constexpr int kMost = 4;
  std::array<Node, kMost> nodes_;
  int count_ = 0;
};

// The point of triangle abc nearest to p and its barycentric weights.
// Source: Ericson, "Real-Time Collision Detection", section 5.1.5.
glm::dvec3 nearestOnTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                             const glm::dvec3& c, glm::dvec3& weights);

template <class Accept>
void TriangleBvh::look(const Node& node, const glm::dvec3& p, const Floats (&place)[3], const Accept& accept,
                       Entry (&stack)[kStack], int& top, Nearest& best) const {
  const Floats squared = node.squaredTo(place);
  const int bottom = top;
  for (int k = 0; k < 4; ++k) {
    const double its = static_cast<double>(squared[k]);
    if (node.child[k] == kNothing || its > best.squared) continue;
    if ((node.child[k] & kLeaf) == 0) {
      stack[top++] = {node.child[k], its};
      if (top - bottom > 1 && stack[top - 2].squared < its) std::swap(stack[top - 2], stack[top - 1]);
      continue;
    }
    const std::uint32_t i = node.child[k] & ~kLeaf;
    if (!accept(order_[i])) continue;
    glm::dvec3 weights;
    const glm::dvec3 q = nearestOnTriangle(p, corners_[i].a, corners_[i].b, corners_[i].c, weights);
    const double exact = glm::dot(p - q, p - q);
    if (exact < best.squared || (exact == best.squared && order_[i] < best.triangle))
      best = {order_[i], exact, q, weights};
  }
}

template <class Accept>
void TriangleBvh::search(const Node* nodes, int count, const glm::dvec3& p, const Accept& accept,
                         Nearest& best) const {
  const Floats place[3] = {all(p.x), all(p.y), all(p.z)};
  Entry stack[kStack];
  int top = 0;
  for (int i = 0; i < count; ++i) look(nodes[i], p, place, accept, stack, top, best);
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.squared <= best.squared) look(nodes_[entry.node], p, place, accept, stack, top, best);
  }
}

template <class Accept>
Nearest TriangleBvh::nearest(const glm::dvec3& p, double bound, const Accept& accept) const {
  Nearest best;
  best.squared = bound * bound;
  search(nodes_.data(), 1, p, accept, best);
  return best;
}

template <class Accept>
Nearest TriangleBvh::first(const Node* nodes, int count, const glm::dvec3& p, int axis, int sign,
                           double length, const Accept& accept) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Floats at = all(p[axis]), at_u = all(p[u]), at_v = all(p[v]);
  Nearest best;
  double way = length;
  std::uint32_t stack[kStack];
  int top = 0;
  const auto look = [&](const Node& node) {
    const Floats near = sign > 0 ? node.low[axis] - at : at - node.high[axis];
    const Floats far = sign > 0 ? node.high[axis] - at : at - node.low[axis];
    const Answers met = (near <= all(way)) & (far >= Floats{}) & (at_u >= node.low[u]) &
                        (at_u <= node.high[u]) & (at_v >= node.low[v]) & (at_v <= node.high[v]);
    for (int k = 0; k < 4; ++k) {
      if (met[k] == 0 || node.child[k] == kNothing) continue;
      if ((node.child[k] & kLeaf) == 0) {
        stack[top++] = node.child[k];
        continue;
      }
      const std::uint32_t i = node.child[k] & ~kLeaf;
      Nearest hit;
      if (!meets(corners_[i], p, axis, hit)) continue;
      const double distance = (hit.point[axis] - p[axis]) * sign;
      if (distance < 0 || distance > way ||
          (distance == way && best.triangle != kCap && order_[i] > best.triangle))
        continue;
      hit.triangle = order_[i];
      hit.squared = distance * distance;
      if (!accept(hit)) continue;
      way = distance;
      best = hit;
    }
  };
  for (int i = 0; i < count; ++i) look(nodes[i]);
  while (top > 0) look(nodes_[stack[--top]]);
  return best;
}

template <class Accept>
Nearest TriangleBvh::first(const Around& around, const glm::dvec3& p, int axis, int sign, double length,
                           const Accept& accept) const {
  return first(around.nodes_.data(), around.count_, p, axis, sign, length, accept);
}

template <class Accept>
Nearest TriangleBvh::first(const glm::dvec3& p, int axis, int sign, double length,
                           const Accept& accept) const {
  return first(nodes_.data(), 1, p, axis, sign, length, accept);
}

}  // namespace kelp::bake

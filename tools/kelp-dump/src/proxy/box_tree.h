// SPDX-License-Identifier: MIT
// A tree of boxes around numbered things: finds the one nearest to a point.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace kelp::dump {

struct TreeBox {
  glm::vec3 low, high;
};

class BoxTree {
 public:
  // `boxes` must contain what they stand for. At least one.
  explicit BoxTree(const std::vector<TreeBox>& boxes) : order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.reserve(2 * (boxes.size() / kLeaf + 1));
    build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
  }

  static constexpr std::uint32_t kNothing = 0xffffffffu;
  struct Nearest {
    double squared;       // its distance
    std::uint32_t thing;  // kNothing: none is nearer than `squared`
  };
  // The thing with the smallest value of squaredDistance(thing) that is below `limit`.
  template <class F>
  Nearest nearest(const glm::dvec3& p, double limit, F&& squaredDistance) const {
    Nearest found{limit, kNothing};
    struct Waiting {
      std::uint32_t node;
      double apart;
    } stack[64];
    int waiting = 0;
    stack[waiting++] = {0, apart(nodes_[0], p)};
    while (waiting > 0) {
      const Waiting next = stack[--waiting];
      if (next.apart >= found.squared) continue;
      const Node& node = nodes_[next.node];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          if (const double squared = squaredDistance(order_[i]); squared < found.squared)
            found = {squared, order_[i]};
        continue;
      }
      Waiting near{next.node + 1, apart(nodes_[next.node + 1], p)},
          far{node.first, apart(nodes_[node.first], p)};
      if (far.apart < near.apart) std::swap(near, far);
      stack[waiting++] = far;
      stack[waiting++] = near;
    }
    return found;
  }

 private:
  static constexpr std::uint32_t kLeaf = 4;
  struct Node {
    TreeBox box;
    std::uint32_t first = 0;  // of a leaf: in order_; else: the second child. The first child comes next.
    std::uint32_t count = 0;  // 0: not a leaf
  };

  static double apart(const Node& node, const glm::dvec3& p) {
    const glm::dvec3 out =
        glm::max(glm::max(glm::dvec3(node.box.low) - p, p - glm::dvec3(node.box.high)), glm::dvec3(0));
    return glm::dot(out, out);
  }

  // Halves by the median of the middles along the longest axis: at most 32 levels.
  void build(const std::vector<TreeBox>& boxes, std::uint32_t begin, std::uint32_t end) {
    const std::size_t at = nodes_.size();
    nodes_.push_back({boxes[order_[begin]], begin, end - begin});
    for (std::uint32_t i = begin; i < end; ++i) {
      nodes_[at].box.low = glm::min(nodes_[at].box.low, boxes[order_[i]].low);
      nodes_[at].box.high = glm::max(nodes_[at].box.high, boxes[order_[i]].high);
    }
    if (end - begin <= kLeaf) return;
    const glm::vec3 extent = nodes_[at].box.high - nodes_[at].box.low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::uint32_t half = begin + (end - begin) / 2;
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
      const float x = boxes[a].low[axis] + boxes[a].high[axis], y = boxes[b].low[axis] + boxes[b].high[axis];
      return x < y || (x == y && a < b);
    };
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, less);
    build(boxes, begin, half);
    nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at].count = 0;
    build(boxes, half, end);
  }

  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace kelp::dump

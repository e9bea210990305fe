// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include <glm/vec3.hpp>

namespace kelp::dump {

struct Triangle {
  glm::dvec3 a, b, c;
};

// Finds the triangle nearest to a point, by a tree of boxes.
class TriangleTree {
 public:
  // At least one triangle.
  explicit TriangleTree(std::vector<Triangle> triangles);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  struct Nearest {
    double squared;  // distance
    const Triangle* triangle;
  };
  Nearest nearest(const glm::dvec3& p) const;

 private:
  struct Node {
    glm::dvec3 low, high;
    std::size_t first = 0;  // of a leaf: its first triangle; else the second child. The first child is next.
    std::size_t count = 0;  // 0: not a leaf
  };
  void build(std::size_t begin, std::size_t end);
  static double squaredDistance(const glm::dvec3& p, const Node& node);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

// Upper bound of the largest distance from a point of the triangles to those of `to`. Too large by at most
// `tolerance`.
double largestDistance(const std::vector<Triangle>& triangles, const TriangleTree& to, double tolerance);

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#include "proxy/covered.h"

#include <algorithm>

namespace kelp::dump {
namespace {

constexpr int kCuts = 2;

struct Square {
  glm::dvec3 middle, u, v;  // u, v: from the middle to its sides

  glm::dvec3 corner(int i) const { return middle + (i % 2 ? u : -u) + (i / 2 ? v : -v); }
};

// The distance to a triangle is convex: what is true of the corners is true of all points between them.
// Squares that need several triangles are cut in four.
bool isCovered(const Square& square, const std::vector<Triangle>& triangles, double squared_limit, int cuts) {
  bool middle = false;
  for (const Triangle& triangle : triangles) {
    int corner = 0;
    while (corner < 4 && squaredDistance(square.corner(corner), triangle) <= squared_limit) ++corner;
    if (corner == 4) return true;
    middle = middle || squaredDistance(square.middle, triangle) <= squared_limit;
  }
  if (cuts == 0 || !middle) return false;
  for (int i = 0; i < 4; ++i)
    if (!isCovered({(square.middle + square.corner(i)) * 0.5, square.u * 0.5, square.v * 0.5}, triangles,
                   squared_limit, cuts - 1))
      return false;
  return true;
}

}  // namespace

bool covered(const VoxelFace& face, const std::vector<Triangle>& triangles, double most) {
  Square square{face.middle(), glm::dvec3(0), glm::dvec3(0)};
  square.u[(face.axis() + 1) % 3] = 0.5;
  square.v[(face.axis() + 2) % 3] = 0.5;
  return isCovered(square, triangles, most * most, kCuts);
}

}  // namespace kelp::dump

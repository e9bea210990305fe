// SPDX-License-Identifier: MIT
#include "reference/cage_distance.h"

#include <algorithm>
#include <cmath>

namespace kelp::reference {
namespace {

using glm::dvec3;
using glm::ivec3;

constexpr std::size_t kLeafTriangles = 4;

using Polygon = std::vector<dvec3>;

// The part of a polygon where at(p) >= 0, a linear function.
template <class At>
Polygon cut(const Polygon& polygon, const At& at) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double from = at(a), to = at(b);
    if (from >= 0) kept.push_back(a);
    if ((from >= 0) != (to >= 0)) kept.push_back(a + from / (from - to) * (b - a));
  }
  return kept;
}
Polygon cutByTetrahedron(Polygon polygon, const std::array<int, 3>& axes, double side) {
  const auto [a, b, c] = axes;
  polygon = cut(polygon, [&, a = a](const dvec3& q) { return side - q[a]; });
  polygon = cut(polygon, [&, a = a, b = b](const dvec3& q) { return q[a] - q[b]; });
  polygon = cut(polygon, [&, b = b, c = c](const dvec3& q) { return q[b] - q[c]; });
  return cut(polygon, [&, c = c](const dvec3& q) { return q[c]; });
}

dvec3 nearestOfSegment(const dvec3& a, const dvec3& b, const dvec3& p) {
  const dvec3 way = b - a;
  const double length2 = glm::dot(way, way);
  return length2 > 0 ? a + std::clamp(glm::dot(p - a, way) / length2, 0.0, 1.0) * way : a;
}
dvec3 nearestOfTriangle(const dvec3 (&c)[3], const dvec3& p) {
  const dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
  const double area2 = glm::dot(normal, normal);
  bool within = area2 > 0;
  for (int i = 0; i < 3 && within; ++i)
    within = glm::dot(glm::cross(c[(i + 1) % 3] - c[i], p - c[i]), normal) >= 0;
  if (within) return p - glm::dot(p - c[0], normal) / area2 * normal;
  dvec3 best = c[0];
  for (int i = 0; i < 3; ++i) {
    const dvec3 at = nearestOfSegment(c[i], c[(i + 1) % 3], p);
    if (glm::distance(at, p) < glm::distance(best, p)) best = at;
  }
  return best;
}

}  // namespace

CageDistance::CageDistance(const CageTruth& truth) : truth_(truth) {
  for (const CageTruth::Cube& cube : truth.cubes_) {
    for (int i = 0; i < truth.side_ * truth.side_ * truth.side_; ++i) {
      const ivec3 voxel(i % truth.side_, i / truth.side_ % truth.side_, i / truth.side_ / truth.side_);
      if (truth.isSolid(cube, cube.corner + voxel)) addVoxel(cube, voxel);
    }
  }
  nodes_.resize(1);
  build(0, 0, triangles_.size());
}

void CageDistance::addVoxel(const CageTruth::Cube& cube, const ivec3& voxel) {
  const dvec3 low(voxel), high = low + 1.0;
  for (int face = 0; face < 6; ++face) {
    const int axis = face >> 1, next = (axis + 1) % 3, last = (axis + 2) % 3;
    ivec3 beside = voxel;
    beside[axis] += face & 1 ? 1 : -1;
    const bool sure = truth_.inverted() == 0 || (beside[axis] >= 0 && beside[axis] < truth_.side_);
    if (sure && truth_.isSolid(cube, cube.corner + beside)) continue;
    Polygon square(4, face & 1 ? high : low);
    for (std::size_t i = 0; i < 4; ++i) {
      square[i][next] = (i + 1) / 2 % 2 ? high[next] : low[next];
      square[i][last] = i / 2 ? high[last] : low[last];
    }
    for (std::size_t t = cube.first; t < cube.end; ++t)
      add(cutByTetrahedron(square, truth_.tetrahedra_[t].axes, truth_.side_), truth_.tetrahedra_[t]);
  }
  if (cube.end - cube.first == 6) return;
  // Beside an inverted tetrahedron others end.
  const double side = truth_.side_;
  const auto isThere = [&](const std::array<int, 3>& axes) {
    for (std::size_t t = cube.first; t < cube.end; ++t)
      if (truth_.tetrahedra_[t].axes == axes) return true;
    return false;
  };
  for (std::size_t t = cube.first; t < cube.end; ++t) {
    const auto [a, b, c] = truth_.tetrahedra_[t].axes;
    dvec3 corners[4] = {dvec3(0), dvec3(0), dvec3(0), dvec3(side)};
    corners[1][a] = corners[2][a] = corners[2][b] = side;
    for (const int without : {1, 2}) {
      if (isThere(without == 1 ? std::array{b, a, c} : std::array{a, c, b})) continue;
      Polygon face{corners[0], corners[3 - without], corners[3]};
      for (int axis = 0; axis < 3; ++axis) {
        face = cut(face, [&](const dvec3& q) { return q[axis] - low[axis]; });
        face = cut(face, [&](const dvec3& q) { return high[axis] - q[axis]; });
      }
      add(face, truth_.tetrahedra_[t]);
    }
  }
}

void CageDistance::add(Polygon polygon, const CageTruth::Tetrahedron& t) {
  const glm::dmat3 posed = glm::inverse(t.turn);
  for (dvec3& p : polygon) p = posed * (p - t.at);
  for (std::size_t i = 2; i < polygon.size(); ++i)
    triangles_.push_back({{polygon[0], polygon[i - 1], polygon[i]}});
}

void CageDistance::build(std::size_t node, std::size_t first, std::size_t count) {
  dvec3 low(INFINITY), high(-INFINITY);
  for (std::size_t i = first; i < first + count; ++i)
    for (const dvec3& p : triangles_[i].corners) low = glm::min(low, p), high = glm::max(high, p);
  nodes_[node] = {low, high, first, count};
  if (count <= kLeafTriangles) return;
  const dvec3 extent = high - low;
  const int axis = extent.x > extent.y && extent.x > extent.z ? 0 : extent.y > extent.z ? 1 : 2;
  const auto begin = triangles_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto middle = begin + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(count),
                   [axis](const Triangle& a, const Triangle& b) {
                     return a.corners[0][axis] + a.corners[1][axis] + a.corners[2][axis] <
                            b.corners[0][axis] + b.corners[1][axis] + b.corners[2][axis];
                   });
  const std::size_t children = nodes_.size();
  nodes_.resize(children + 2);
  build(children, first, count / 2);
  build(children + 1, first + count / 2, count - count / 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
}

void CageDistance::look(std::size_t node, const dvec3& p, double& best2, dvec3& found) const {
  const auto toBox2 = [&](std::size_t i) {
    const dvec3 off = p - glm::clamp(p, nodes_[i].low, nodes_[i].high);
    return glm::dot(off, off);
  };
  const Node& at = nodes_[node];
  for (std::size_t i = at.first; i < at.first + at.count; ++i) {
    const dvec3 near = nearestOfTriangle(triangles_[i].corners, p);
    const double d2 = glm::dot(near - p, near - p);
    if (d2 < best2) best2 = d2, found = near;
  }
  if (at.count > 0) return;
  std::size_t order[2] = {at.first, at.first + 1};
  if (toBox2(order[1]) < toBox2(order[0])) std::swap(order[0], order[1]);
  for (const std::size_t child : order)
    if (toBox2(child) < best2) look(child, p, best2, found);
}

dvec3 CageDistance::nearest(const dvec3& p) const {
  double best2 = INFINITY;
  dvec3 found(0);
  look(0, p, best2, found);
  return found;
}

bool CageDistance::inside(const dvec3& p) const {
  const auto holds = [&](const CageTruth::Ball& ball) {
    return glm::distance(ball.middle, p) <= ball.radius;
  };
  for (const CageTruth::Group& group : truth_.groups_) {
    if (!holds(group.ball)) continue;
    for (std::size_t i = group.first; i < group.end; ++i) {
      const CageTruth::Cube& cube = truth_.cubes_[i];
      if (!holds(cube.ball)) continue;
      for (std::size_t t = cube.first; t < cube.end; ++t) {
        const CageTruth::Tetrahedron& tetrahedron = truth_.tetrahedra_[t];
        const dvec3 q = tetrahedron.turn * p + tetrahedron.at;
        const auto [a, b, c] = tetrahedron.axes;
        if (q[a] > truth_.side_ || q[b] > q[a] || q[c] > q[b] || q[c] < 0) continue;
        const ivec3 voxel = glm::min(ivec3(q), ivec3(truth_.side_ - 1));
        if (truth_.isSolid(cube, cube.corner + voxel)) return true;
      }
    }
  }
  return false;
}

}  // namespace kelp::reference

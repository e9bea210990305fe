// SPDX-License-Identifier: MIT
#include "kelp/voxelize/surface/touched_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kelp/common/dense_index.h"

namespace kelp::bake {
namespace {

// A triangle cut by two parallel planes and then by two others has at most 7 corners.
struct Polygon {
  std::array<glm::dvec3, 8> corner;
  int corners = 0;

  void add(const glm::dvec3& p) { corner[static_cast<std::size_t>(corners++)] = p; }
  const glm::dvec3& at(int i) const { return corner[static_cast<std::size_t>(i)]; }
};

// Clips a convex polygon to side * (p[axis] - plane) >= 0.
Polygon clip(const Polygon& in, int axis, double plane, double side) {
  Polygon out;
  for (int i = 0; i < in.corners; ++i) {
    const glm::dvec3 &from = in.at(i), &to = in.at(i + 1 < in.corners ? i + 1 : 0);
    const double a = side * (from[axis] - plane), b = side * (to[axis] - plane);
    if (a >= 0) out.add(from);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
      glm::dvec3 cut = from + (to - from) * (a / (a - b));
      cut[axis] = plane;
      out.add(cut);
    }
  }
  return out;
}

// The cells that an extent along an axis reaches into. A face of a cell belongs to the cells beneath, unless
// nothing else does.
struct Cells {
  int first = 0, last = 0;
};
Cells cellsOf(const Polygon& polygon, int axis, int size) {
  double low = polygon.at(0)[axis], high = low;
  for (int i = 1; i < polygon.corners; ++i) {
    low = std::min(low, polygon.at(i)[axis]);
    high = std::max(high, polygon.at(i)[axis]);
  }
  // A cast truncates, which is floor for values that are not negative. Without SSE4.1 std::floor is a call.
  const auto within = [&](double place) { return std::clamp(place, 0.0, static_cast<double>(size)); };
  const int first = std::min(static_cast<int>(within(low)), size - 1);
  const auto whole = static_cast<int>(within(high));
  const int last = static_cast<double>(whole) < within(high) ? whole : whole - 1;
  return {first, std::clamp(last, first, size - 1)};
}

struct Box {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
};

class TouchedCells {
 public:
  // Cells with an edge of `scale` voxels. They need not reach beyond the box of the triangles, however large
  // the frame.
  TouchedCells(const glm::dmat4& node_to_voxel, const Box& box, double scale)
      : to_cell_(glm::dmat3(node_to_voxel) / scale) {
    const glm::dvec3 low = glm::floor(box.low / scale);
    origin_ = glm::dvec3(node_to_voxel[3]) / scale - low;
    size_ = glm::max(glm::ivec3(glm::ceil(box.high / scale) - low), glm::ivec3(1));
    bits_.resize(denseCount(size_));
  }

  double count(const TriangleSoup& soup) {
    for (const TriangleSoup::Triangle& triangle : soup.triangles) {
      Polygon polygon;
      for (const std::uint32_t vertex : triangle.vertex)
        polygon.add(to_cell_ * glm::dvec3(soup.positions[vertex]) + origin_);
      touch(polygon);
    }
    return static_cast<double>(count_);
  }

 private:
  void touch(const Polygon& triangle) {
    const Cells slabs = cellsOf(triangle, 2, size_.z);
    if (slabs.first == slabs.last) {
      // Of a scan most triangles are as small as this: nothing has to be cut.
      const Cells rows = cellsOf(triangle, 1, size_.y);
      if (rows.first == rows.last) return touchRow(cellsOf(triangle, 0, size_.x), rows.first, slabs.first);
    }
    for (int z = slabs.first; z <= slabs.last; ++z) {
      const Polygon slab = cut(triangle, 2, z, slabs);
      if (slab.corners == 0) continue;
      const Cells rows = cellsOf(slab, 1, size_.y);
      for (int y = rows.first; y <= rows.last; ++y) {
        const Polygon row = cut(slab, 1, y, rows);
        if (row.corners == 0) continue;
        touchRow(cellsOf(row, 0, size_.x), y, z);
      }
    }
  }

  void touchRow(const Cells& run, int y, int z) {
    const std::size_t start = denseIndex(size_, 0, y, z);
    for (int x = run.first; x <= run.last; ++x) {
      std::vector<bool>::reference bit = bits_[start + static_cast<std::size_t>(x)];
      if (!bit) ++count_;
      bit = true;
    }
  }

  static Polygon cut(const Polygon& polygon, int axis, int cell, const Cells& cells) {
    Polygon out = polygon;
    if (cell > cells.first) out = clip(out, axis, cell, 1);
    if (cell < cells.last && out.corners > 0) out = clip(out, axis, cell + 1, -1);
    return out;
  }

  glm::dmat3 to_cell_;
  glm::dvec3 origin_;
  glm::ivec3 size_;
  std::vector<bool> bits_;
  std::uint64_t count_ = 0;
};

}  // namespace

double touchedCells(const TriangleSoup& soup, const Frame& frame, double edge) {
  Box box;
  // What a triangle touches in the mean over all places of the lattice, without the one voxel that each
  // touches: its projections along the axes, and its extents along them (Steiner's formula for the sum of a
  // triangle and a cube).
  double area = 0, length = 0;
  for (const TriangleSoup::Triangle& triangle : soup.triangles) {
    glm::dvec3 corner[3];
    for (std::size_t i = 0; i < 3; ++i) {
      corner[i] = glm::dvec3(frame.node_to_voxel * glm::dvec4(soup.positions[triangle.vertex[i]], 1));
      box.low = glm::min(box.low, corner[i]);
      box.high = glm::max(box.high, corner[i]);
    }
    const glm::dvec3 projected = glm::abs(glm::cross(corner[1] - corner[0], corner[2] - corner[0])) * 0.5;
    const glm::dvec3 extent = glm::max(glm::max(corner[0], corner[1]), corner[2]) -
                              glm::min(glm::min(corner[0], corner[1]), corner[2]);
    area += projected.x + projected.y + projected.z;
    length += extent.x + extent.y + extent.z;
  }
  if (soup.triangles.empty()) return 0;
  const glm::dvec3 side = glm::max(box.high - box.low, glm::dvec3(1));
  const double scale = std::max({edge, std::cbrt(side.x * side.y * side.z / kCountedCells),
                                 std::sqrt(area / kCountedTouches), length / kCountedTouches});
  const double fine = TouchedCells(frame.node_to_voxel, box, scale).count(soup);
  if (scale <= edge) return fine;
  // Counts at an edge and at twice that edge tell what grows with the square of its inverse from what grows
  // with the inverse.
  const double coarse = TouchedCells(frame.node_to_voxel, box, 2 * scale).count(soup), finer = scale / edge;
  const double square = std::clamp(2 * fine - 4 * coarse, 0.0, fine);
  return square * finer * finer + (fine - square) * finer;
}

}  // namespace kelp::bake

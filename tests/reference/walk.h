// SPDX-License-Identifier: MIT
// The search for the first touch along a curve in the undeformed volume, for maps of any kind. A curve has
// at(x), a point in voxels of the volume, and hull(x0, x1, low, high), a box around it between two
// parameters, which shrinks with them.
#pragma once

#include <algorithm>
#include <cmath>

#include "reference/ground_truth.h"

namespace kelp::reference {

// Walks a curve q(x), x in [x0, x1], in order and stops at the first point inside the solid shrunk by `erode`
// (negative: grown).
template <class Curve>
class Walk {
 public:
  Walk(const Volume& volume, const Curve& q, double erode)
      : volume_(volume), q_(q), erode_(erode), extent_(volume.scale * glm::dvec3(volume.size0)) {}

  // Sets x and voxel and answers true at the first touch.
  bool first(double x0, double x1, double& x, glm::ivec3& voxel) const {
    glm::dvec3 low, high;
    q_.hull(x0, x1, low, high);
    const glm::dvec3 side = high - low;
    const double longest = std::max({side.x, side.y, side.z});
    const double grow = std::max(-erode_, 0.0);
    if (!meetsVolume(low - grow, high + grow)) return false;
    if (longest <= 3.0) {
      if (!anySolid(low - grow, high + grow, voxel)) return false;
      if (erode_ > 0) {
        if (allSolid(low - erode_, high + erode_)) {
          x = x0;
          return true;
        }
        // The box that the surroundings of every point of the hull have in common: is there something empty
        // in it?
        const glm::dvec3 core_low = high - erode_, core_high = low + erode_;
        if (core_low.x <= core_high.x && core_low.y <= core_high.y && core_low.z <= core_high.z &&
            !allSolid(core_low, core_high))
          return false;
      }
    }
    const double middle = 0.5 * (x0 + x1);
    if (longest < 1e-6 || middle <= x0 || middle >= x1) {
      x = x0;
      return erode_ <= 0 || allSolid(q_.at(x0) - erode_, q_.at(x0) + erode_);
    }
    return first(x0, middle, x, voxel) || first(middle, x1, x, voxel);
  }

 private:
  bool meetsVolume(const glm::dvec3& low, const glm::dvec3& high) const {
    return low.x <= extent_.x && low.y <= extent_.y && low.z <= extent_.z && high.x >= 0 && high.y >= 0 &&
           high.z >= 0;
  }

  // Voxels whose closed cubes meet the box; those of a coarse level end where the volume does.
  void voxelsOf(const glm::dvec3& low, const glm::dvec3& high, glm::ivec3& from, glm::ivec3& to) const {
    for (int a = 0; a < 3; ++a) {
      from[a] = std::max(static_cast<int>(std::ceil(low[a])) - 1, 0);
      to[a] = std::min(static_cast<int>(std::floor(high[a])), volume_.size[a] - 1);
    }
  }

  bool isSolid(int x, int y, int z) const {
    const bool tiled = volume_.tile.x > 0;
    const glm::ivec3 v = tiled ? glm::ivec3(x, y, z) % volume_.tile : glm::ivec3(x, y, z);
    const glm::ivec3& size = tiled ? volume_.tile : volume_.size;
    return volume_.solid[static_cast<std::size_t>(v.x) +
                         static_cast<std::size_t>(size.x) *
                             (static_cast<std::size_t>(v.y) +
                              static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z))] != 0;
  }

  bool anySolid(const glm::dvec3& low, const glm::dvec3& high, glm::ivec3& voxel) const {
    glm::ivec3 from, to;
    voxelsOf(low, high, from, to);
    for (int z = from.z; z <= to.z; ++z) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
          if (!isSolid(x, y, z)) continue;
          voxel = {x, y, z};
          return true;
        }
      }
    }
    return false;
  }

  // True if the whole box is inside the union of the solid voxels. The outside of the volume is empty.
  bool allSolid(const glm::dvec3& low, const glm::dvec3& high) const {
    if (low.x < 0 || low.y < 0 || low.z < 0 || high.x > extent_.x || high.y > extent_.y || high.z > extent_.z)
      return false;
    glm::ivec3 from, to;
    voxelsOf(low, high, from, to);
    for (int z = from.z; z <= to.z; ++z) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
          if (!isSolid(x, y, z)) return false;
        }
      }
    }
    return true;
  }

  const Volume& volume_;
  const Curve& q_;
  double erode_;
  glm::dvec3 extent_;
};

}  // namespace kelp::reference

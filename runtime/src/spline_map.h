// SPDX-License-Identifier: MIT
// The map of space of section 3.1 of the paper as distances need it, in double precision. sweep_map.h has
// that of swept parts; searches know nothing else of how space is bent.
//
// A deformed point (x, y, z) is at rest at (x - Sx, stretch (y - low), z - Sz), where the spline S has height
// y. Part space, voxels of level 0.
#pragma once

#include <span>

#include <glm/glm.hpp>

#include "kelp/formats/spline.h"

namespace kelp::runtime {

class SplineMap {
 public:
  // A place on the spline. Without initial values: searches have many of them on the stack.
  struct Cut {
    int segment;
    double t;
    glm::dvec3 at;     // S(t); at.y is the height of the cut
    glm::dvec3 slope;  // dS/dt
  };
  struct Box {
    glm::dvec3 min{0}, max{0};
  };

  // The knots must be in order (checkKnots), and live as long as the map.
  SplineMap(std::span<const Knot> knots, const glm::ivec3& size);

  std::span<const Knot> knots() const { return knots_; }
  double low() const { return low_; }
  double high() const { return high_; }
  // The cut at a height from low() to high(), to some billionths of a voxel: its own height says which.
  Cut cut(double y) const;
  // The cut that has a point at rest at this height.
  Cut cutOfRest(double y) const { return cut(glm::clamp(low_ + y / stretch_, low_, high_)); }
  // A cut between two others, in ascending order, halfway in t. False: there is none.
  bool between(const Cut& a, const Cut& b, Cut& middle) const;

  glm::dvec3 toRest(const Cut& cut, const glm::dvec3& p) const {
    return {p.x - cut.at.x, stretch_ * (cut.at.y - low_), p.z - cut.at.z};
  }
  // The gradient of a function of the deformed point, but for its length, from that at rest.
  glm::dvec3 gradient(const Cut& cut, const glm::dvec3& at_rest) const;
  // How far the set is at rest from the rest point of another point on the line along y.
  struct RestAt {
    double (*call)(const void* user, const Cut& cut) = nullptr;
    const void* user = nullptr;
  };
  // A distance of which it is known: if nothing of some set is nearer than `rest` to the rest point of a
  // point at the cut, then nothing of the deformed set is nearer than this to the point. Where the map
  // shears strongly, it asks once how far the set is from the line along y elsewhere.
  double bound(const Cut& cut, double rest, const RestAt& rest_at) const;
  // Contains all of the spline between two cuts in ascending order.
  Box sweep(const Cut& a, const Cut& b) const;
  // True if a voxel between two cuts is as good as its box: the spline hardly moves there. side: of voxels.
  bool isFine(const Cut& from, const Cut& to, const glm::dvec3& low, const glm::dvec3& high,
              double side) const;
  // The point of a voxel (low to high at rest) between two cuts that is nearest to a point, as far as its
  // own height tells.
  glm::dvec3 nearest(const Cut& from, const Cut& to, const glm::dvec3& low, const glm::dvec3& high,
                     const glm::dvec3& point) const;

 private:
  // A segment: S(t) = p0 + t (m0 + t (b + t a)).
  struct Cubic {
    glm::dvec3 p0, m0, b, a;
  };
  Cubic cubic(int segment) const;
  double gentleBound(const Cut& cut, double rest) const;
  double alongSpline(const Cut& cut, double rest, const Cut* second, double second_rest, Cut& weakest) const;
  static Cut cutOf(const Cubic& cubic, int segment, double t);
  Cut cutAt(int segment, double t) const { return cutOf(cubic(segment), segment, t); }

  std::span<const Knot> knots_;
  float height_ = 0;
  double low_ = 0, high_ = 0, stretch_ = 1;
};

}  // namespace kelp::runtime

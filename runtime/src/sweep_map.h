// SPDX-License-Identifier: MIT
// The map of space of swept parts as distances need it, in double precision: a slice of the part for each arc
// of its center line. Part space, voxels of level 0.
#pragma once

#include <glm/glm.hpp>

#include "kelp/formats/sweep.h"

namespace kelp::runtime {

// The slice of one arc. A section has the axes u, towards the axis of curvature, and v, across; x and z from
// the center line are turned against them. Around the axis of curvature, a point is at the distance
// (1 - curvature u) / curvature and at an angle that follows from its height at rest.
struct SweepSlice {
  glm::dvec3 middle, along, inward, across;
  double curvature;
  double c, s;          // u = c x + s z, v = c z - s x
  double y, rise;       // at rest: the height of `middle`, and that of each length of the arc
  double low, high;     // heights at rest
  double half;          // of its length
  double half_chord;    // sin(f) / curvature, with the half angle f = curvature * half
  double cosine, sine;  // of f
  double most_u;        // within the part

  // How much the rest height changes at most for a length in the world, between points of the slice with
  // these values of 1 - curvature u; at least 1, as u and v change by that length. Around the axis of
  // curvature, points at the distances r and s and at angles that differ by a are
  // sqrt((r - s)^2 + 4 r s sin(a / 2)^2) apart; a is at most 2 f, so sin(a / 2) is at least
  // a / 2 * sin(f) / f.
  double stretch(double room_a, double room_b) const;
};

// A point as one slice sees it.
struct SweepPoint {
  glm::dvec3 off{0};      // to it from the nearest point of the slice's wedge, which is between the two joint
                          // planes; what follows is of that nearest point
  double off_length = 0;  // 0: it is within the wedge
  bool nearly = false;    // or so little beyond a joint that rounding may have put it there
  double u = 0, v = 0;
  double room = 0;              // 1 - curvature u; 0 on the axis of curvature
  double cosine = 1, sine = 0;  // of its angle
  double tangent = 0;           // of its angle, over the curvature: its length along a straight arc
};

class SweepMap {
 public:
  // A height at rest. Without initial values: searches have many of them on the stack.
  struct Cut {
    int arc;
    double y;
  };
  // The chain must live as long as the map.
  SweepMap(const ArcChain& chain, const glm::ivec3& size);

  int arcs() const { return chain_.count; }
  const glm::dvec2& middle() const { return middle_; }  // of the part at rest, x and z
  // More than what the float32 numbers of the arcs move anything.
  double slack() const { return slack_; }

  SweepSlice slice(int arc) const;
  // The arc whose slice is the nearest, as far as balls around them tell.
  int nearestArc(const glm::dvec3& point) const;
  // True if nothing of the slice is nearer than this.
  bool isBeyond(int arc, const glm::dvec3& point, double distance) const;
  SweepPoint see(int arc, const SweepSlice& slice, const glm::dvec3& point) const;
  // The rest point of what see() found; y within the slice.
  glm::dvec3 toRest(const SweepSlice& slice, const SweepPoint& at) const;
  // A radius: the ball around a point of the part is solid if, at rest, one of `depth` around its rest point
  // is. The straight way from the point to the nearest surface stays in the solid, so it is at rest longer
  // by the greatest stretch there at most.
  double ballOf(int arc, const glm::dvec3& point, const glm::dvec3& rest, double depth) const;

  Cut cutOfRest(double y) const;
  // A cut between two others, in ascending order: a joint, or halfway. False: there is none.
  bool between(const Cut& from, const Cut& to, Cut& middle) const;
  // The last of the arcs between two cuts; the first is from.arc.
  int lastArc(const Cut& from, const Cut& to) const;
  // A slanted box: `center` and any of -half to half added contain the part of a box at rest that is in
  // one slice.
  struct Slab {
    glm::dvec3 center{0};
    glm::dvec3 half[4];           // the section's x and z, along, inward
    double bulge = 0, along = 0;  // how far the arc is from straight; half the length
  };
  Slab slab(int arc, const Cut& from, const Cut& to, const glm::dvec3& low, const glm::dvec3& high) const;
  // As in SplineMap.
  bool isFine(const Cut& from, const Cut& to, const glm::dvec3& low, const glm::dvec3& high,
              double side) const;
  glm::dvec3 nearest(const Cut& from, const Cut& to, const glm::dvec3& low, const glm::dvec3& high,
                     const glm::dvec3& point) const;

 private:
  const ArcChain& chain_;
  glm::dvec2 middle_{0};
  double slack_ = 0;
};

}  // namespace kelp::runtime

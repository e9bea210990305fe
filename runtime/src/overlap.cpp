// SPDX-License-Identifier: MIT
// closestPoint(), overlaps() and sphereCast() with one instance: searches with different goals.
#include <algorithm>
#include <cmath>

#include "cages/cage_search.h"
#include "solid_search.h"

namespace kelp::runtime {
namespace {

glm::dvec3 beyond(const FrameBox& box) { return glm::max(glm::abs(box.center) - box.half, glm::dvec3(0)); }

// The point of a leaf that is nearest to `at`, as far as its bending tells; in the frame.
glm::dvec3 placeNearest(const CagedSolid&, const SearchFrame& frame, const CageLeaf& leaf,
                        const glm::dvec3& at) {
  return frame.place(leaf.map.place(nearestOf(leaf, frame, at)));
}
glm::dvec3 placeNearest(const PosedSolid<SweepMap>& solid, const SearchFrame& frame,
                        const SearchLeaf<SweepMap>& leaf, const glm::dvec3& at) {
  return frame.place(solid.map.nearest(*leaf.from, *leaf.to, leaf.low, leaf.high, at));
}
glm::dvec3 placeNearest(const PosedSolid<SplineMap>& solid, const SearchFrame& frame,
                        const SearchLeaf<SplineMap>& leaf, const glm::dvec3& at) {
  const SplineMap& map = solid.map;
  glm::dvec3 p = map.nearest(*leaf.from, *leaf.to, leaf.low, leaf.high, at), in_frame = frame.place(p);
  if (!frame.shears) return in_frame;
  // Along one axis after the other, each time to the nearest point, as if the leaf were not bent.
  const SplineMap::Cut cut = map.cut(p.y);
  const glm::dvec3 low(cut.at.x + leaf.low.x, leaf.from->at.y, cut.at.z + leaf.low.z),
      high(cut.at.x + leaf.high.x, leaf.to->at.y, cut.at.z + leaf.high.z);
  constexpr int kSweeps = 32;
  for (int i = 0; i < 3 * kSweeps; ++i) {
    const glm::dvec3& axis = frame.to_frame[i % 3];
    const double to =
        std::clamp(p[i % 3] - glm::dot(axis, in_frame) / glm::dot(axis, axis), low[i % 3], high[i % 3]);
    in_frame += (to - p[i % 3]) * axis;
    p[i % 3] = to;
  }
  const SplineMap::Cut there = map.cut(p.y);
  return frame.place({p.x - cut.at.x + there.at.x, there.at.y, p.z - cut.at.z + there.at.z});
}

template <class Solid>
struct ClosestGoal {
  const Solid& solid;
  const SearchFrame& frame;
  glm::dvec3 at;  // part space
  double reach;   // world
  double best = INFINITY;
  glm::dvec3 found{0};
  bool any = false, ran_out = false;

  double key(const FrameBox& box) const { return glm::length(beyond(box)); }
  double limit() const { return std::min(best, reach); }
  // Any leaf within reach is taken, although its point that is found may be beyond.
  template <class Leaf>
  void visit(const Leaf& leaf, double) {
    const glm::dvec3 in_frame = placeNearest(solid, frame, leaf, at);
    const double length = glm::length(in_frame);
    if (length >= best) return;
    best = length;
    found = in_frame;
    any = true;
  }
  void giveUp(double) { ran_out = true; }
};

// The goals below look for anything that touches a shape. apart(box): whether the box surely does not;
// towards(box): how promising it is, the least first.
template <class Shape>
struct TouchGoal {
  Shape shape;
  bool touches = false;

  double key(const FrameBox& box) const { return shape.apart(box) ? INFINITY : shape.towards(box); }
  double limit() const { return touches ? -1.0 : INFINITY; }
  template <class Leaf>
  void visit(const Leaf&, double) {
    touches = true;
  }
  void giveUp(double) { touches = true; }
};

struct FrameSphere {
  double radius;
  bool apart(const FrameBox& box) const {
    const glm::dvec3 off = beyond(box);
    return glm::dot(off, off) > radius * radius;
  }
  double towards(const FrameBox& box) const { return glm::length(box.center); }
};

// The part of the line from 0 to `way`, 0 to 1, that lies in a box. False: none.
bool clipWay(const glm::dvec3& way, const glm::dvec3& center, const glm::dvec3& half, double& from) {
  double to = 1;
  from = 0;
  for (int i = 0; i < 3; ++i) {
    const double low = center[i] - half[i], high = center[i] + half[i];
    if (way[i] == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    from = std::max(from, std::min(low / way[i], high / way[i]));
    to = std::min(to, std::max(low / way[i], high / way[i]));
  }
  return from <= to;
}

struct FrameCapsule {
  glm::dvec3 way;  // from one end, at the eye, to the other
  double radius;
  double toLine(const glm::dvec3& p) const {
    return glm::distance(p, std::clamp(glm::dot(p, way) / glm::dot(way, way), 0.0, 1.0) * way);
  }
  bool apart(const FrameBox& box) const {
    double from = 0;
    return toLine(box.center) > radius + glm::length(box.half) ||
           !clipWay(way, box.center, box.half + radius, from);
  }
  double towards(const FrameBox& box) const { return toLine(box.center); }
};

struct FrameOrientedBox {
  glm::dmat3 axes;  // unit
  glm::dvec3 half;
  bool apart(const FrameBox& box) const {
    const glm::dvec3 local = glm::abs(glm::transpose(axes) * box.center);
    if (glm::length(glm::max(local - half, glm::dvec3(0))) > glm::length(box.half)) return true;
    for (int i = 0; i < 3; ++i) {
      if (local[i] > half[i] + glm::dot(glm::abs(axes[i]), box.half)) return true;
      const glm::dvec3 row(axes[0][i], axes[1][i], axes[2][i]);
      if (std::abs(box.center[i]) > box.half[i] + glm::dot(glm::abs(row), half)) return true;
    }
    return false;
  }
  double towards(const FrameBox& box) const { return glm::length(box.center); }
};

struct CastGoal {
  glm::dvec3 way;
  double radius;
  double best = 1;
  bool hit = false, ran_out = false;

  // When the sphere first touches the box at the earliest: both the box grown by the radius, and the ball
  // around it, contain all centers of spheres that touch it. From the place of the way that is nearest to the
  // center, and with room for rounding, because the way may be much longer than the box.
  double key(const FrameBox& box) const {
    const glm::dvec3 size = glm::abs(box.center);
    const double grown = radius + 1e-15 * (size.x + size.y + size.z);
    double from = 0;
    if (!clipWay(way, box.center, box.half + grown, from)) return INFINITY;
    const double reach = grown + glm::length(box.half), way2 = glm::dot(way, way);
    const double nearest = glm::dot(way, box.center) / way2;
    const glm::dvec3 off = box.center - nearest * way;
    const double half2 = (reach * reach - glm::dot(off, off)) / way2;
    if (half2 < 0) return INFINITY;
    const double half = std::sqrt(half2);
    if (nearest + half < 0 || nearest - half > 1) return INFINITY;
    return std::max(from, nearest - half);
  }
  double limit() const { return hit ? best : INFINITY; }
  template <class Leaf>
  void visit(const Leaf&, double key) {
    best = std::min(best, key);
    hit = true;
  }
  void giveUp(double key) {
    best = std::min(best, key);
    ran_out = true;
  }
};

template <class Map, class Goal>
void search(const PosedSolid<Map>& solid, const SearchFrame& frame, Goal& goal) {
  SolidSearch<Map, Goal>(solid, frame, goal).run();
}
template <class Goal>
void search(const CagedSolid& solid, const SearchFrame& frame, Goal& goal) {
  CageSearch<Goal>(solid, frame, goal).run();
}

// True if a point is in solid that a search does not see.
bool isHidden(const CagedSolid& solid, const glm::dvec3& world) {
  return isInMiddle(solid, glm::inverse(solid.to_world) * (world - solid.origin));
}
template <class Map>
bool isHidden(const PosedSolid<Map>&, const glm::dvec3&) {
  return false;
}

// True if all of the part is farther than `reach` from a point, so far as its distances say.
template <class Solid>
bool isBeyond(const Solid& solid, const glm::vec3& point, float reach) {
  const std::optional<Distance> found = distanceToPart(solid, point);
  return found && found->bound > reach;
}

// The frame's eye must be a point of the shape.
template <class Solid, class Shape>
bool touches(const Solid& solid, const SearchFrame& frame, const Shape& shape) {
  if (isHidden(solid, frame.eye)) return true;
  TouchGoal<Shape> goal{shape};
  search(solid, frame, goal);
  return goal.touches;
}

}  // namespace

void findClosest(const Instance& instance, const glm::dvec3& point, ClosestPoint& nearest) {
  ClosestPoint best = nearest;
  const bool drawn = eachSolid(instance, [&]<class Solid>(const Solid& solid) {
    const SearchFrame frame(solid, point);
    ClosestGoal<Solid> goal{solid, frame, glm::inverse(solid.to_world) * (point - solid.origin),
                            double{best.distance}};
    if (isHidden(solid, point)) {
      goal.best = 0;
      goal.any = true;
    } else {
      search(solid, frame, goal);
    }
    best.ran_out |= goal.ran_out;
    const float length = static_cast<float>(goal.best);
    if (!goal.any || (best.part && !(length < best.distance))) return true;
    best.distance = length;
    best.point = glm::vec3(frame.toWorld(goal.found));
    best.part = solid.part;
    return best.distance > 0;
  });
  if (drawn) nearest = best;
}

bool touches(const Instance& instance, const Sphere& shape) {
  bool found = false;
  const bool drawn = eachSolid(instance, [&](const auto& solid) {
    if (isBeyond(solid, shape.center, shape.radius)) return true;
    const SearchFrame frame(solid, glm::dvec3(shape.center));
    found = touches(solid, frame, FrameSphere{double{shape.radius}});
    return !found;
  });
  return drawn && found;
}
bool touches(const Instance& instance, const Capsule& shape) {
  bool found = false;
  const bool drawn = eachSolid(instance, [&](const auto& solid) {
    const float reach = shape.radius + glm::distance(shape.a, shape.b);
    if (isBeyond(solid, shape.a, 1.000001f * reach)) return true;
    const SearchFrame frame(solid, glm::dvec3(shape.a));
    const glm::dvec3 way = glm::dvec3(shape.b) - glm::dvec3(shape.a);
    found = touches(solid, frame, FrameCapsule{frame.turn(way), double{shape.radius}});
    return !found;
  });
  return drawn && found;
}
bool touches(const Instance& instance, const OrientedBox& shape) {
  bool found = false;
  const bool drawn = eachSolid(instance, [&](const auto& solid) {
    if (isBeyond(solid, shape.center, 1.000001f * glm::length(shape.half_size))) return true;
    const SearchFrame frame(solid, glm::dvec3(shape.center));
    const glm::dmat3 axes = frame.from_world * glm::mat3_cast(glm::normalize(glm::dquat(shape.rotation)));
    found = touches(solid, frame, FrameOrientedBox{axes, glm::dvec3(shape.half_size)});
    return !found;
  });
  return drawn && found;
}

void cast(const Instance& instance, const glm::dvec3& from, const glm::dvec3& way, double radius,
          SphereCast& nearest) {
  SphereCast best = nearest;
  const bool drawn = eachSolid(instance, [&](const auto& solid) {
    const SearchFrame frame(solid, from);
    CastGoal goal{frame.turn(way), radius};
    goal.best = double{best.t};
    goal.hit = best.hit || best.ran_out;
    if (isHidden(solid, from))
      goal.best = 0, goal.hit = true;
    else
      search(solid, frame, goal);
    if (!(goal.best < double{best.t}) && !(goal.hit && !best.part)) return true;
    // Rounded towards 0, so that the sphere does not touch.
    best.t = std::max(static_cast<float>(goal.best) * (1 - 1e-6f), 0.0f);
    best.part = solid.part;
    best.ran_out = goal.ran_out;
    best.hit = !goal.ran_out;
    return best.t > 0;
  });
  if (drawn) nearest = best;
}

}  // namespace kelp::runtime

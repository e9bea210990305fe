// SPDX-License-Identifier: MIT
// closestPoint(), overlaps() and sphereCast() with one instance: searches with different goals.
#include <algorithm>
#include <cmath>

#include "distance_queries.h"
#include "solid_search.h"

namespace kelp::runtime {
namespace {

glm::dvec3 beyond(const FrameBox& box) { return glm::max(glm::abs(box.centre) - box.half, glm::dvec3(0)); }

struct ClosestGoal {
  const PosedSolid& solid;
  const SearchFrame& frame;
  glm::dvec3 at;  // part space
  double reach;   // world
  double best = INFINITY;
  glm::dvec3 found{0};
  bool any = false, ran_out = false;

  double key(const FrameBox& box) const { return glm::length(beyond(box)); }
  double limit() const { return std::min(best, reach); }
  // Any leaf within reach is taken, although its point that is found may be beyond.
  void visit(const SearchLeaf& leaf, double) {
    const double y = std::clamp(at.y, leaf.from->at.y, leaf.to->at.y);
    SplineMap::Cut cut = y == leaf.from->at.y ? *leaf.from : y == leaf.to->at.y ? *leaf.to : solid.map.cut(y);
    glm::dvec3 p(cut.at.x + std::clamp(at.x - cut.at.x, leaf.low.x, leaf.high.x), cut.at.y,
                 cut.at.z + std::clamp(at.z - cut.at.z, leaf.low.z, leaf.high.z));
    glm::dvec3 in_frame = frame.place(p);
    if (frame.shears) {
      // Along one axis after the other, each time to the nearest point, as if the leaf were not bent.
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
      const SplineMap::Cut there = solid.map.cut(p.y);
      in_frame = frame.place({p.x - cut.at.x + there.at.x, there.at.y, p.z - cut.at.z + there.at.z});
    }
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
  void visit(const SearchLeaf&, double) { touches = true; }
  void giveUp(double) { touches = true; }
};

struct FrameSphere {
  double radius;
  bool apart(const FrameBox& box) const {
    const glm::dvec3 off = beyond(box);
    return glm::dot(off, off) > radius * radius;
  }
  double towards(const FrameBox& box) const { return glm::length(box.centre); }
};

// The part of the line from 0 to `way`, 0 to 1, that lies in a box. False: none.
bool clipWay(const glm::dvec3& way, const glm::dvec3& centre, const glm::dvec3& half, double& from) {
  double to = 1;
  from = 0;
  for (int i = 0; i < 3; ++i) {
    const double low = centre[i] - half[i], high = centre[i] + half[i];
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
    return toLine(box.centre) > radius + glm::length(box.half) ||
           !clipWay(way, box.centre, box.half + radius, from);
  }
  double towards(const FrameBox& box) const { return toLine(box.centre); }
};

struct FrameOrientedBox {
  glm::dmat3 axes;  // unit
  glm::dvec3 half;
  bool apart(const FrameBox& box) const {
    const glm::dvec3 local = glm::abs(glm::transpose(axes) * box.centre);
    if (glm::length(glm::max(local - half, glm::dvec3(0))) > glm::length(box.half)) return true;
    for (int i = 0; i < 3; ++i) {
      if (local[i] > half[i] + glm::dot(glm::abs(axes[i]), box.half)) return true;
      const glm::dvec3 row(axes[0][i], axes[1][i], axes[2][i]);
      if (std::abs(box.centre[i]) > box.half[i] + glm::dot(glm::abs(row), half)) return true;
    }
    return false;
  }
  double towards(const FrameBox& box) const { return glm::length(box.centre); }
};

struct CastGoal {
  glm::dvec3 way;
  double radius;
  double best = 1;
  bool hit = false, ran_out = false;

  // When the sphere first touches the box at the earliest: both the box grown by the radius, and the ball
  // around it, contain all centres of spheres that touch it. From the place of the way that is nearest to the
  // centre, and with room for rounding, because the way may be much longer than the box.
  double key(const FrameBox& box) const {
    const glm::dvec3 size = glm::abs(box.centre);
    const double grown = radius + 1e-15 * (size.x + size.y + size.z);
    double from = 0;
    if (!clipWay(way, box.centre, box.half + grown, from)) return INFINITY;
    const double reach = grown + glm::length(box.half), way2 = glm::dot(way, way);
    const double nearest = glm::dot(way, box.centre) / way2;
    const glm::dvec3 off = box.centre - nearest * way;
    const double half2 = (reach * reach - glm::dot(off, off)) / way2;
    if (half2 < 0) return INFINITY;
    const double half = std::sqrt(half2);
    if (nearest + half < 0 || nearest - half > 1) return INFINITY;
    return std::max(from, nearest - half);
  }
  double limit() const { return hit ? best : INFINITY; }
  void visit(const SearchLeaf&, double key) {
    best = std::min(best, key);
    hit = true;
  }
  void giveUp(double key) {
    best = std::min(best, key);
    ran_out = true;
  }
};

template <class Goal>
void search(const PosedSolid& solid, const SearchFrame& frame, Goal& goal) {
  SolidSearch<Goal>(solid, frame, goal).run();
}

// Whether all of the part is farther than `reach` from a point, so far as its distances say.
bool isBeyond(const PosedSolid& solid, const glm::vec3& point, float reach) {
  const std::optional<Distance> found = distanceToPart(solid, point);
  return found && found->bound > reach;
}

template <class Shape>
bool touches(const PosedSolid& solid, const SearchFrame& frame, const Shape& shape) {
  TouchGoal<Shape> goal{shape};
  search(solid, frame, goal);
  return goal.touches;
}

// Calls use(solid) for each solid part until it returns false.
template <class Use>
void eachSolid(const Instance& instance, const Use& use) {
  const auto parts = static_cast<int>(instance.asset->pack().parts().size());
  for (int part = 0; part < parts; ++part) {
    const std::optional<PosedSolid> solid = posedSolid(instance, part);
    if (solid && !use(*solid)) return;
  }
}

}  // namespace

void findClosest(const Instance& instance, const glm::dvec3& point, ClosestPoint& nearest) {
  eachSolid(instance, [&](const PosedSolid& solid) {
    const SearchFrame frame(solid, point);
    ClosestGoal goal{solid, frame, glm::inverse(solid.to_world) * (point - solid.origin),
                     double{nearest.distance}};
    search(solid, frame, goal);
    nearest.ran_out |= goal.ran_out;
    const float length = static_cast<float>(goal.best);
    if (!goal.any || (nearest.part >= 0 && !(length < nearest.distance))) return true;
    nearest.distance = length;
    nearest.point = glm::vec3(frame.toWorld(goal.found));
    nearest.part = solid.part;
    return nearest.distance > 0;
  });
}

bool touches(const Instance& instance, const Sphere& shape) {
  bool found = false;
  eachSolid(instance, [&](const PosedSolid& solid) {
    if (isBeyond(solid, shape.centre, shape.radius)) return true;
    const SearchFrame frame(solid, glm::dvec3(shape.centre));
    found = touches(solid, frame, FrameSphere{double{shape.radius}});
    return !found;
  });
  return found;
}
bool touches(const Instance& instance, const Capsule& shape) {
  bool found = false;
  eachSolid(instance, [&](const PosedSolid& solid) {
    const float reach = shape.radius + glm::distance(shape.a, shape.b);
    if (isBeyond(solid, shape.a, 1.000001f * reach)) return true;
    const SearchFrame frame(solid, glm::dvec3(shape.a));
    const glm::dvec3 way = glm::dvec3(shape.b) - glm::dvec3(shape.a);
    found = touches(solid, frame, FrameCapsule{frame.turn(way), double{shape.radius}});
    return !found;
  });
  return found;
}
bool touches(const Instance& instance, const OrientedBox& shape) {
  bool found = false;
  eachSolid(instance, [&](const PosedSolid& solid) {
    if (isBeyond(solid, shape.centre, 1.000001f * glm::length(shape.half_size))) return true;
    const SearchFrame frame(solid, glm::dvec3(shape.centre));
    const glm::dmat3 axes = frame.from_world * glm::mat3_cast(glm::normalize(glm::dquat(shape.rotation)));
    found = touches(solid, frame, FrameOrientedBox{axes, glm::dvec3(shape.half_size)});
    return !found;
  });
  return found;
}

void cast(const Instance& instance, const glm::dvec3& from, const glm::dvec3& way, double radius,
          SphereCast& nearest) {
  eachSolid(instance, [&](const PosedSolid& solid) {
    const SearchFrame frame(solid, from);
    CastGoal goal{frame.turn(way), radius};
    goal.best = double{nearest.t};
    goal.hit = nearest.hit || nearest.ran_out;
    search(solid, frame, goal);
    if (!(goal.best < double{nearest.t}) && !(goal.hit && nearest.part < 0)) return true;
    // Rounded towards 0, so that the sphere does not touch.
    nearest.t = std::max(static_cast<float>(goal.best) * (1 - 1e-6f), 0.0f);
    nearest.part = solid.part;
    nearest.ran_out = goal.ran_out;
    nearest.hit = !goal.ran_out;
    return nearest.t > 0;
  });
}

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// distance() with one part with cages.
//
// Let c be the point of a tetrahedron that is nearest to p. The tetrahedron is convex, so a point x of it is
// at least sqrt(|p - c|^2 + |c - x|^2) from p; and |c - x| is at least the least factor by which the gradient
// lengthens vectors times the distance at rest. Also, |p - x| is at least that factor times the distance at
// rest from the point that the tetrahedron's map takes to p. The bound of a tetrahedron is the greater of the
// two; that of the part is the least of its tetrahedra.
#include "../posed_solid.h"
#include "../rest_distance.h"
#include "cage_map.h"

namespace kelp::runtime {
namespace {

// What is known of a point at rest.
struct CageRest {
  double outside = 0;  // how far the solid is at least
  double inside = 0;   // how far all else is
  bool solid = false;
  glm::dvec3 away{0};  // unit, or 0
  int level = 0;
};
CageRest restAt(const CagedSolid& solid, const glm::dvec3& at) {
  const glm::dvec3 held = glm::clamp(at, glm::dvec3(0), glm::dvec3(solid.size)), off = at - held;
  const double off2 = glm::dot(off, off);
  if (!std::isfinite(off2)) return {};  // of a tetrahedron that is all but flat
  const std::optional<RestDistance> found = restDistance(*solid.asset, solid.part, held);
  if (!found) return {};
  CageRest rest;
  rest.outside = std::sqrt(off2 + found->bound * found->bound);
  rest.solid = found->inside && off2 == 0;
  rest.inside = rest.solid ? found->depth : 0.0;
  rest.away = glm::dvec3(found->gradient);
  const double gradient2 = glm::dot(rest.away, rest.away);
  if (gradient2 > 0) rest.away /= std::sqrt(gradient2);
  if (off2 > 0) rest.away = (off + found->bound * rest.away) / std::max(rest.outside, 1e-9);
  rest.level = found->level;
  return rest;
}

constexpr double kEnough = 0.9;

// The tetrahedra of a cage around a point. `best` stays above 0, so that all that hold the point are looked
// at. Derived: look(cell, number, tetrahedron) for those that reach nearer than `best`.
template <class Derived>
struct CageBound {
  const CagedSolid& solid;
  glm::dvec3 p;
  double best = INFINITY, skipped = INFINITY;
  glm::dvec3 away{0};  // part space
  int level = 0;
  // More than rounding moves points.
  double slack = 1e-9 * (1 + glm::length(p) + glm::length(glm::dvec3(solid.size)));

  double key(const Box& box) const { return std::sqrt(toBox2(box, p)); }
  // What could make the bound but little less is not looked at: it counts as far as its box is.
  double limit() const { return kEnough * best; }
  void skip(double at_least) { skipped = std::min(skipped, at_least); }
  double bound() const { return std::max(std::min(best, skipped) - slack, 0.0); }
  void visit(std::uint32_t cell) {
    glm::dvec3 corners[8];
    for (int i = 0; i < 8; ++i) corners[i] = glm::dvec3(solid.cage.nodes[solid.cage.cage->node(cell, i)]);
    for (const CageTetrahedron& kind : kCageTetrahedra) {
      glm::dvec3 low = corners[0], high = corners[0];
      for (const int corner : kind.corners) {
        low = glm::min(low, corners[corner]);
        high = glm::max(high, corners[corner]);
      }
      const double to_box = glm::distance(p, glm::clamp(p, low, high));
      if (!(to_box < limit())) {
        skip(to_box);
        continue;
      }
      const PosedTetrahedron t = tetrahedronBy(kind, *solid.cage.cage, cell, corners);
      static_cast<Derived*>(this)->look(cell, t, to_box);
    }
  }
  bool hasMask(std::uint32_t cell) const { return solid.cage.cage->cell(cell)[1] != 0; }
  // off: to p, from the nearest point of the tetrahedron; grows: the way away at rest there.
  void take(double bound, const PosedTetrahedron& t, const glm::dvec3& off, const CageRest& rest) {
    best = std::max(bound, kLeastDepth);
    level = rest.level;
    const glm::dvec3 turned = glm::transpose(glm::inverse(t.gradient)) * rest.away;
    const double length2 = glm::dot(turned, turned);
    const double share = std::max(std::sqrt(std::max(bound * bound - glm::dot(off, off), 0.0)), 1e-3);
    away =
        off + (length2 > 0 && std::isfinite(length2) ? share / std::sqrt(length2) * turned : glm::dvec3(0));
  }
};

// How far the solid is.
struct CageOutside : CageBound<CageOutside> {
  bool inside = false;  // p is in the solid

  void look(std::uint32_t cell, const PosedTetrahedron& t, double) {
    if (inside || !(t.volume > 0)) return;
    const NearestPoint nearest = nearestPoint(t, p);
    if (!(nearest.distance < limit())) return skip(nearest.distance);
    const bool within = nearest.distance <= slack;
    const double least = leastScale(t.gradient);
    const glm::dvec3 continued = t.toRest(p);
    double bound = within ? 0.0 : least * restAt(solid, continued).outside;
    if (!(bound < limit())) return skip(bound);
    const CageRest rest = restAt(solid, nearest.rest);
    if (within && rest.solid && isOfPiece(*solid.cage.cage, cell, nearest.rest)) {
      inside = true;
      level = rest.level;
      best = 0;  // ends the search
      return;
    }
    const auto bent = [&](double at_rest) { return std::hypot(nearest.distance, least * at_rest); };
    bound = std::max(bound, bent(rest.outside));
    if (bound < limit() && hasMask(cell)) {
      const Cage& cage = *solid.cage.cage;
      bound = std::max(
          {bound, bent(toMask(cage, cell, nearest.rest, true)), least * toMask(cage, cell, continued, true)});
    }
    if (!(bound < limit())) return skip(bound);
    take(bound, t, p - nearest.at, rest);
  }
};

// Of a point in the solid: how far all else is. Cells and tetrahedra end where there is none beyond, and
// before inverted ones nothing is sure.
struct CageDepth : CageBound<CageDepth> {
  void look(std::uint32_t cell, const PosedTetrahedron& t, double to_box) {
    if (!(t.volume > 0)) {
      best = std::min(best, to_box);
      return;
    }
    const NearestPoint nearest = nearestPoint(t, p);
    if (!(nearest.distance < limit())) return skip(nearest.distance);
    const Cage& cage = *solid.cage.cage;
    const CageRest rest = restAt(solid, nearest.rest);
    const double least = leastScale(t.gradient);
    double bound = std::hypot(nearest.distance, least * rest.inside);
    if (hasMask(cell) && bound > nearest.distance) {
      const double at_rest = std::min(rest.inside, toMask(cage, cell, nearest.rest, false));
      bound = std::hypot(nearest.distance, least * at_rest);
    }
    if (bound < best) take(bound, t, nearest.at - p, rest);
    for (const int face : {0, 3}) {
      if (cage.beyond(cell, cellFace(*t.kind, face)) != kCageOutside) continue;
      const NearestPoint end = nearestOfFace(t, face, p);
      if (end.distance < best) take(end.distance, t, end.at - p, rest);
    }
  }
};

}  // namespace

bool isInMiddle(const CagedSolid& solid, const glm::dvec3& point) {
  return toBox2(solid.cage.bounds, point) == 0 && turnsOfInside(solid.cage, point) > 0;
}

std::optional<Distance> distanceToPart(const CagedSolid& solid, const glm::vec3& world) {
  const glm::dmat3 to_part = glm::inverse(solid.to_world);
  const glm::dvec3 point = to_part * (glm::dvec3(world) - solid.origin);
  CageOutside outside{{solid, point}};
  searchCells(solid.cage, outside);
  if (!outside.inside && !isInMiddle(solid, point)) {
    if (outside.best == INFINITY) return std::nullopt;
    Distance found = answerOf(solid, to_part, outside.bound(), outside.away);
    found.level = outside.level;
    return found;
  }
  CageDepth depth{{solid, point}};
  searchCells(solid.cage, depth);
  Distance found = answerOf(solid, to_part, -std::max(depth.bound(), kLeastDepth), depth.away);
  found.level = outside.level;
  return found;
}

}  // namespace kelp::runtime

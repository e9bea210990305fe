// SPDX-License-Identifier: MIT
// distance() with one swept part: the least bound of its slices; README.md, "Distances in bent space".
#include <algorithm>
#include <cmath>

#include "posed_solid.h"
#include "rest_distance.h"

namespace kelp::runtime {
namespace {

class SweptDistance {
 public:
  SweptDistance(const PosedSolid<SweepMap>& solid, const glm::dvec3& point) : solid_(solid), point_(point) {}

  // False: no distances are in memory.
  bool find() {
    const SweepMap& map = solid_.map;
    const int first = map.nearestArc(point_);
    if (!look(first)) return false;
    for (int arc = 0; arc < map.arcs(); ++arc)
      if (arc != first && !map.isBeyond(arc, point_, inside() ? 0.0 : best_) && !look(arc)) return false;
    return true;
  }
  bool inside() const { return depth_ > 0; }
  double bound() const { return inside() ? -depth_ : std::max(best_ - 2 * solid_.map.slack(), 0.0); }
  const glm::dvec3& away() const { return away_; }
  int level() const { return level_; }

 private:
  bool look(int arc) {
    const SweepMap& map = solid_.map;
    const SweepSlice slice = map.slice(arc);
    const SweepPoint at = map.see(arc, slice, point_);
    glm::dvec3 rest = map.toRest(slice, at);
    const glm::dvec3 held = glm::clamp(rest, glm::dvec3(0), glm::dvec3(solid_.size));
    const glm::dvec3 beside = rest - held;
    // At least as far, whatever is solid.
    const double near2 = at.off_length * at.off_length + glm::dot(beside, beside);
    if (near2 > 0 && (near2 >= best_ * best_ || inside())) return true;
    const std::optional<RestDistance> found = restDistance(*solid_.asset, solid_.part, held);
    if (!found) return false;
    if (found->inside && near2 == 0 && (!at.nearly || found->depth > 4 * map.slack())) {
      const double depth = std::max(map.ballOf(arc, point_, rest, found->depth), kLeastDepth);
      if (depth <= depth_) return true;
      depth_ = depth;
      turnAway(slice, at, beside, *found, depth);
      return true;
    }
    const double bound = std::sqrt(near2 + squaredAlong(slice, at, glm::dot(beside, beside), found->bound));
    if (inside() || bound >= best_) return true;
    best_ = bound;
    turnAway(slice, at, beside, *found, std::sqrt(bound * bound - at.off_length * at.off_length));
    return true;
  }
  // The square of what is left of a bound at rest where the slice shortens lengths.
  static double squaredAlong(const SweepSlice& slice, const SweepPoint& at, double beside2, double rest) {
    if (!(at.room > 0)) return 0;
    const double reach = std::sqrt(beside2 + rest * rest);
    const double room = 1 - slice.curvature * std::min(slice.most_u, at.u + reach);
    const double left = rest / slice.stretch(at.room, room);
    return left * left;
  }
  void turnAway(const SweepSlice& slice, const SweepPoint& at, const glm::dvec3& beside,
                const RestDistance& found, double weight) {
    level_ = found.level;
    const glm::dvec3 gradient(found.gradient);
    const double length2 = glm::dot(gradient, gradient);
    glm::dvec3 rest = beside;
    if (length2 > 0) rest += std::max(found.bound, found.inside ? 1.0 : 0.0) / std::sqrt(length2) * gradient;
    const glm::dvec3 inward = at.cosine * slice.inward - at.sine * slice.along,
                     along = at.cosine * slice.along + at.sine * slice.inward;
    glm::dvec3 bent =
        (slice.c * rest.x + slice.s * rest.z) * inward + (slice.c * rest.z - slice.s * rest.x) * slice.across;
    if (at.room > 0) bent += rest.y * slice.rise / at.room * along;
    const double bent2 = glm::dot(bent, bent);
    away_ = at.off;
    if (bent2 > 0) away_ += std::max(weight, 1e-3) / std::sqrt(bent2) * bent;
  }

  const PosedSolid<SweepMap>& solid_;
  const glm::dvec3 point_;
  double best_ = INFINITY, depth_ = 0;
  glm::dvec3 away_{0};
  int level_ = 0;
};

}  // namespace

std::optional<Distance> distanceToPart(const PosedSolid<SweepMap>& solid, const glm::vec3& world) {
  const glm::dmat3 to_part = glm::inverse(solid.to_world);
  SweptDistance swept(solid, to_part * (glm::dvec3(world) - solid.origin));
  if (!swept.find()) return std::nullopt;
  Distance found = answerOf(solid, to_part, swept.bound(), swept.away());
  found.level = swept.level();
  return found;
}

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// Checks of instances for all queries, and distance() with one instance.
#include <algorithm>
#include <cmath>

#include "asset_impl.h"
#include "kelp/simd/bound_knots.h"
#include "posed_part.h"
#include "posed_solid.h"
#include "rest_distance.h"

namespace kelp::runtime {

Result<bool> checkInstance(const Instance& instance) {
  if (!instance.asset) return Error{ErrorCode::kMisuse, "an instance without an asset"};
  const Asset& asset = *instance.asset;
  if (!asset.pack().hasDistances()) return Error{ErrorCode::kUnsupportedFeature, "the pack has no distances"};
  const auto parts = static_cast<int>(asset.pack().parts().size());
  if (!asset.loadsDistances())
    return Error{ErrorCode::kMisuse, "the asset was opened without AssetOptions::distance_level"};
  for (int part = 0; part < parts; ++part) {
    const int levels = DistanceReader::levels(asset, part);
    int level = levels - 1;
    while (level >= 0 && !DistanceReader::level(asset, part, level)) --level;
    if (levels == 0 || level >= 0) continue;
    const std::uint16_t failure = DistanceReader::failure(asset, part);
    const Error none{ErrorCode::kNotYet, "no distances of a part are in memory yet",
                     static_cast<std::uint64_t>(part), Error::Unit::kPart};
    const Error failed{static_cast<ErrorCode>(failure), "all distances of a part failed to load", none.offset,
                       none.unit};
    return failure != 0 ? failed : none;
  }
  if (instance.pose && instance.pose->parts() != parts) return false;
  for (int part = 0; part < parts; ++part) {
    const PosedPart posed = posedPart(instance, part);
    if (!posed.part->cages.empty()) {
      const auto cage = posedCage(instance, part, 0, CageUse::kTree);
      if (!cage && cage.error().code == ErrorCode::kOutOfMemory) return cage.error();
      if (!cage) return false;
    } else if (instance.pose && !posed.isSwept() && !posed.check()) {
      return false;
    }
  }
  return true;
}

std::optional<SolidPlace> solidPlace(const Instance& instance, int part) {
  const Part& of = instance.asset->pack().parts()[static_cast<std::size_t>(part)];
  if (of.kind != PartKind::kSolid || knotsOf(instance, part).size() < 2) return std::nullopt;
  const glm::dmat4 to_world(matrixOf(instance, part));
  const glm::dmat3 linear(to_world);
  const double volume = glm::determinant(linear), away = glm::dot(to_world[3], glm::dvec4(1));
  if (!(std::abs(volume) > 0) || !std::isfinite(volume) || !std::isfinite(away)) return std::nullopt;
  return SolidPlace{instance.asset, part, of.size, linear, glm::dvec3(to_world[3])};
}

double leastScale(const glm::dmat3& matrix) {
  const glm::dmat3 g = glm::transpose(matrix) * matrix;
  const double xy = std::abs(g[0][1]), xz = std::abs(g[0][2]), yz = std::abs(g[1][2]);
  // No eigenvalue is below these (Gershgorin): exact for columns that are perpendicular.
  const double diagonal = std::min({g[0][0], g[1][1], g[2][2]});
  const double disks = std::min({g[0][0] - xy - xz, g[1][1] - xy - yz, g[2][2] - xz - yz});
  if (disks > 0.98 * diagonal) return std::sqrt(disks);
  // Else the volume over the greatest area, which is the product of the other two singular values. The
  // greatest eigenvalue in closed form errs by some 1e-8 of itself; the least one would, too, of the
  // greatest.
  const double size = std::sqrt(g[0][0] + g[1][1] + g[2][2]);
  if (!(size > 0)) return 0;
  const glm::dmat3 m = matrix / size;
  const glm::dmat3 areas(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  const glm::dmat3 a = glm::transpose(areas) * areas;
  const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3;
  const glm::dmat3 d = a - mean * glm::dmat3(1);
  const double spread = std::sqrt((d[0][0] * d[0][0] + d[1][1] * d[1][1] + d[2][2] * d[2][2] +
                                   2 * (a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2])) /
                                  6);
  double greatest = mean;
  if (spread > 0) {
    const double turn = std::acos(std::clamp(glm::determinant(d / spread) / 2, -1.0, 1.0)) / 3;
    greatest += 2 * spread * std::cos(turn);
  }
  // Largest rounding error of volume and areas, with a size of 1.
  constexpr double kRounding = 1e-15, kClosedForm = 1e-7;
  const double volume = std::abs(glm::dot(m[0], areas[0])) - kRounding;
  return size * std::max(volume, 0.0) / (std::sqrt(greatest * (1 + kClosedForm)) + kRounding);
}

namespace {

// A point with respect to a part: the nearest one within the deformed bounds, and where that is at rest.
struct Projected {
  glm::dvec3 off{0};  // from the bounds to the point
  double slack = 0;   // how far the cut is from the point's height
  SplineMap::Cut cut{};
  glm::dvec3 rest{0};      // within the part's box
  glm::dvec3 rest_off{0};  // from there to the rest point
};
Projected project(const PosedSolid<SplineMap>& solid, const glm::dvec3& point) {
  Projected at;
  const glm::dvec3 size(solid.size);
  const auto place = [&](const glm::dvec3& p) {
    at.off = point - p;
    at.cut = solid.map.cut(p.y);
    at.slack = std::abs(at.cut.at.y - p.y);
    const glm::dvec3 rest = solid.map.toRest(at.cut, p);
    at.rest = glm::clamp(rest, glm::dvec3(0), size);
    at.rest_off = rest - at.rest;
  };
  const double y = std::clamp(point.y, solid.map.low(), solid.map.high());
  place({point.x, y, point.z});
  // Bounds cost time, and tell little that is new of a point nearly within the part's box at rest.
  constexpr double kNearly2 = 64;
  if (at.off.y == 0 && glm::dot(at.rest_off, at.rest_off) < kNearly2) return at;
  const Box box = simd::boundKnots(solid.map.knots(), solid.size);
  const glm::dvec3 inside = glm::clamp(point, glm::dvec3(box.min), glm::dvec3(box.max));
  if (inside.x != point.x || inside.z != point.z) place({inside.x, y, inside.z});
  return at;
}

// Where the line along y through a point is at rest, and how far the solid is there.
struct AlongY {
  const PosedSolid<SplineMap>* solid;
  glm::dvec3 point;

  SplineMap::RestAt ask() const {
    return {[](const void* user, const SplineMap::Cut& cut) {
              const auto& self = *static_cast<const AlongY*>(user);
              const glm::dvec3 rest = self.solid->map.toRest(cut, self.point);
              const glm::dvec3 held = glm::clamp(rest, glm::dvec3(0), glm::dvec3(self.solid->size));
              const auto found = restDistance(*self.solid->asset, self.solid->part, held);
              const double off2 = glm::dot(rest - held, rest - held);
              return found ? std::sqrt(off2 + found->bound * found->bound) : 0.0;
            },
            this};
  }
};

}  // namespace

Distance answerOf(const SolidPlace& solid, const glm::dmat3& to_part, double bound, const glm::dvec3& away) {
  Distance found;
  found.bound = static_cast<float>(bound * leastScale(solid.to_world) * (1 - 1e-6));
  found.part = solid.part;
  const glm::dvec3 in_world = glm::transpose(to_part) * away;
  const double length2 = glm::dot(in_world, in_world);
  if (length2 > 0 && std::isfinite(length2)) found.away = glm::vec3(in_world / std::sqrt(length2));
  return found;
}

std::optional<Distance> distanceToPart(const PosedSolid<SplineMap>& solid, const glm::vec3& world) {
  const glm::dmat3 to_part = glm::inverse(solid.to_world);
  const glm::dvec3 point = to_part * (glm::dvec3(world) - solid.origin);
  const Projected at = project(solid, point);
  const std::optional<RestDistance> rest = restDistance(*solid.asset, solid.part, at.rest);
  if (!rest) return std::nullopt;
  const double off2 = glm::dot(at.off, at.off), rest_off2 = glm::dot(at.rest_off, at.rest_off);
  const bool inside = rest->inside && off2 == 0 && rest_off2 == 0;
  const double rest_bound = inside ? rest->depth : std::sqrt(rest_off2 + rest->bound * rest->bound);
  const AlongY line{&solid, point - at.off};
  const double bent = std::max(
      solid.map.bound(at.cut, rest_bound, inside ? SplineMap::RestAt{} : line.ask()) - at.slack, 0.0);
  // The nearest point within the bounds sees the solid at an obtuse angle to the point.
  const double bound = inside ? std::max(bent, kLeastDepth) : std::sqrt(off2 + bent * bent);

  const double gradient2 = glm::dot(glm::dvec3(rest->gradient), glm::dvec3(rest->gradient));
  const glm::dvec3 stored = gradient2 > 0 ? glm::dvec3(rest->gradient) / std::sqrt(gradient2) : glm::dvec3(0);
  glm::dvec3 away =
      solid.map.gradient(at.cut, at.rest_off + rest->bound * stored + (inside ? stored : glm::dvec3(0)));
  const double length2 = glm::dot(away, away);
  away = at.off + (length2 > 0 ? std::max(bent, 1e-3) / std::sqrt(length2) * away : glm::dvec3(0));
  Distance found = answerOf(solid, to_part, inside ? -bound : bound, away);
  found.level = rest->level;
  return found;
}

void findNearest(const Instance& instance, const glm::vec3& point, Distance& nearest) {
  Distance best = nearest;
  const bool drawn = eachSolid(instance, [&](const auto& solid) {
    const std::optional<Distance> found = distanceToPart(solid, point);
    if (found && (!best.part || found->bound < best.bound)) best = *found;
    return true;
  });
  if (drawn) nearest = best;
}

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// One solid part of an instance as distances see it.
#pragma once

#include <optional>

#include "kelp/cages/posed_cage.h"
#include "kelp/runtime/distance.h"
#include "posed_part.h"
#include "spline_map.h"
#include "sweep_map.h"

namespace kelp::runtime {

struct SolidPlace {
  const Asset* asset = nullptr;
  int part = 0;
  glm::ivec3 size{0};      // voxels of level 0
  glm::dmat3 to_world{1};  // part space -> world, without the translation
  glm::dvec3 origin{0};    // of part space, in the world
};
// Map: how the part bends, a SplineMap or a SweepMap.
template <class Map>
struct PosedSolid : SolidPlace {
  Map map;
};
// A part with cages, in its finest one, with the tree.
struct CagedSolid : SolidPlace {
  PosedCage cage;
};

// Errors that all queries return for an instance. False: it is not drawn, so it has no solid. Of swept solid
// parts without cages, eachSolid() says whether they are drawn: it makes their arcs anyway.
Result<bool> checkInstance(const Instance& instance);
// Where the part is, if it is solid and its matrix is finite.
std::optional<SolidPlace> solidPlace(const Instance& instance, int part);
// distance() with one part. nullopt: none of its distances is in memory.
std::optional<Distance> distanceToPart(const PosedSolid<SplineMap>& solid, const glm::vec3& point);
std::optional<Distance> distanceToPart(const PosedSolid<SweepMap>& solid, const glm::vec3& point);
std::optional<Distance> distanceToPart(const CagedSolid& solid, const glm::vec3& point);
// True if a point of part space is in the middle of the solid, where no cell is.
bool isInMiddle(const CagedSolid& solid, const glm::dvec3& point);
// The answer for a part from what is known in part space: a bound, below 0 inside, and the way away.
Distance answerOf(const SolidPlace& solid, const glm::dmat3& to_part, double bound, const glm::dvec3& away);
// Voxels: less than rounding, so that it promises nothing on the surface itself, but its sign says that a
// point is inside.
inline constexpr double kLeastDepth = 1e-30;
// The least factor by which the matrix lengthens a vector, or a little less; 0 for a singular one.
double leastScale(const glm::dmat3& matrix);

// Calls use(solid) for each solid part until it returns false. The instance must have passed
// checkInstance(). False: a swept part cannot be drawn, so the instance has no solid, whatever use() saw.
template <class Use>
bool eachSolid(const Instance& instance, const Use& use) {
  bool wanted = true;
  const auto parts = static_cast<int>(instance.asset->pack().parts().size());
  for (int part = 0; part < parts; ++part) {
    const PosedPart posed = posedPart(instance, part);
    if (!posed.part->cages.empty()) {
      const std::optional<SolidPlace> place = wanted ? solidPlace(instance, part) : std::nullopt;
      const auto cage = posedCage(instance, part, 0, CageUse::kTree);
      if (place && cage) wanted = use(CagedSolid{*place, *cage});
    } else if (posed.isSwept()) {
      ArcChain chain;
      if (!posed.arcs(chain)) return false;
      if (!wanted) continue;
      const std::optional<SolidPlace> place = solidPlace(instance, part);
      if (place) wanted = use(PosedSolid<SweepMap>{*place, SweepMap(chain, place->size)});
    } else if (wanted) {
      const std::optional<SolidPlace> place = solidPlace(instance, part);
      if (place) wanted = use(PosedSolid<SplineMap>{*place, SplineMap(posed.knots, place->size)});
    }
  }
  return true;
}

// Queries of kelp/runtime/distance.h with one instance that passed checkInstance(), and arguments that were
// checked. Each improves its result, if it can.
void findNearest(const Instance& instance, const glm::vec3& point, Distance& nearest);
void findClosest(const Instance& instance, const glm::dvec3& point, ClosestPoint& nearest);
bool touches(const Instance& instance, const Sphere& shape);
bool touches(const Instance& instance, const Capsule& shape);
bool touches(const Instance& instance, const OrientedBox& shape);
void cast(const Instance& instance, const glm::dvec3& from, const glm::dvec3& way, double radius,
          SphereCast& nearest);

}  // namespace kelp::runtime

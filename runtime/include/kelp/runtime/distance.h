// SPDX-License-Identifier: MIT
// Distances, overlaps and sphere casts on the CPU. They need a pack with distances (kelp-bake's default) in
// an asset that loads them: AssetOptions::distance_level.
//
// The solid is the union of the closed level-0 voxels of all solid parts, bent by the pose, in the world:
// what is drawn at full detail. Where only coarser distances are in memory, answers stay on the safe side.
//
// Parts with cages are bent by their finest cage. Their solid is that of all tetrahedra that are not
// inverted, and the middle of it, where no cell is: all points that the surface of the cells around it
// encloses.
// Where a cage stretches voxels, answers to a voxel are to one as it is stretched, and a search may take
// longer.
//
// All lengths are in the unit of the world. "A voxel" is the longest side of a voxel of the finest level of
// distances in memory, in the world. Nothing allocates or blocks. Any thread may call while nobody changes
// the pose; of parts with cages the first query after a change of the pose makes what all need. An instance
// that is not drawn (a pose that Pose::check() refuses, a singular matrix) has no solid.
//
// Errors of all functions: kMisuse for numbers that are not finite, for lengths that must be above 0 and are
// not, for an instance without an asset, and if the asset was opened without AssetOptions::distance_level;
// kUnsupportedFeature if the pack has no distances; kNotYet if some solid part has none in memory yet (if the
// memory budget has no room for its coarsest ones, that stays so); why they failed to load (kCorrupt, kIo),
// if none of a part's could be loaded: until Asset::retry(). With a list, `offset` is the index
// of the instance.
//
// `boxes`: bounds() of each instance, if the caller has them; a caller that asks often makes them once a
// frame. Empty: they are made here, for every call; one instance alone needs none. kMisuse for any other
// number of them. With boxes, an instance whose box is too far to matter is not asked, so its errors are not
// found; without, the first error of any instance is the answer, unless the query ended before.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <variant>

#include "kelp/runtime/instance.h"

namespace kelp::runtime {

inline constexpr float kFarAway = std::numeric_limits<float>::infinity();

struct Distance {
  // Never more than the distance to the solid; 0 where that is not known to be above 0. Inside of the solid:
  // below 0, and the surface is at least so far away; by a hair (1e-30 voxels) where no depth is known, as
  // on the surface itself. kFarAway: there is no solid.
  float bound = kFarAway;
  glm::vec3 away{0, 1, 0};  // unit; where the distance grows fastest, as far as the stored distances tell
  int instance = 0;         // index in the list that was given
  std::optional<int> part;  // whose distance it is; none: there is no solid
  int level = 0;            // of the distances that answered
};
Result<Distance> distance(Instances instances, const glm::vec3& point, std::span<const Box> boxes = {});

struct ClosestPoint {
  glm::vec3 point{0};         // of the solid
  float distance = kFarAway;  // to it; kFarAway: there is no solid within reach
  int instance = 0;           // index in the list that was given
  std::optional<int> part;    // none: there is no solid within reach
  bool ran_out = false;       // the search took too long: nearer solid may exist
};
// A point of the solid that is nearest to `point`, to a voxel; `point` itself inside. Solid nearer than
// `reach` (above 0; may be kFarAway) is found, and solid that is farther by less than a voxel may be found,
// too. Where the finest levels are not in memory, the point belongs to a coarser voxel. A search that would
// take too long (some milliseconds) ends early and sets ran_out. What it found belongs to the solid; if it
// found nothing, it answers kFarAway.
Result<ClosestPoint> closestPoint(Instances instances, const glm::vec3& point, float reach = kFarAway,
                                  std::span<const Box> boxes = {});

struct Sphere {
  glm::vec3 center{0};
  float radius = 0;  // at least 0
};
struct Capsule {  // all points within `radius` of the line from `a` to `b`, which differ
  glm::vec3 a{0}, b{0};
  float radius = 0;  // at least 0
};
struct OrientedBox {
  glm::vec3 center{0};
  glm::vec3 half_size{0};          // above 0
  glm::quat rotation{1, 0, 0, 0};  // of the box, in the world
};
using Shape = std::variant<Sphere, Capsule, OrientedBox>;
// The index of the first instance whose solid the shape touches; nullopt: none. An overlap is never missed.
// One may be found where the solid is only near: within a voxel of the shape, within two where the instance's
// matrix shears. Also if a search would take too long.
Result<std::optional<int>> overlaps(Instances instances, const Shape& shape, std::span<const Box> boxes = {});

struct SphereCast {
  bool hit = false;
  float t = 1;              // of the way, 0 to 1, that is free
  glm::vec3 center{0};      // of the sphere there
  glm::vec3 away{0, 1, 0};  // unit; Distance::away of the center. Meaningless without a hit
  int instance = 0;         // index in the list that was given
  std::optional<int> part;  // that was hit, or where the search ran out
  bool ran_out = false;     // the search took too long: the way up to t is free, and no more is known
};
// Moves a sphere (radius at least 0) from one point to another one, and stops it before it touches the solid:
// it never passes through, and the solid is then within a voxel of it; within two where the instance's matrix
// shears; and two millionths of the way more, as `t` is rounded. t is 0 if it starts so near.
Result<SphereCast> sphereCast(Instances instances, const glm::vec3& from, const glm::vec3& to, float radius,
                              std::span<const Box> boxes = {});

}  // namespace kelp::runtime

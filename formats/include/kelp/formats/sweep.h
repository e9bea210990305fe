// SPDX-License-Identifier: MIT
// Swept parts: the sections of the part stay perpendicular to its center line, a chain of circular arcs. So
// they keep their thickness however far the part bends, and it may turn back and curl. formats/SPEC.md,
// "Bending", says how knots become arcs; this is that, in double precision. Part space, voxels of level 0.
#pragma once

#include <optional>
#include <span>

#include "kelp/formats/error.h"
#include "kelp/formats/geometry.h"
#include "kelp/formats/spline.h"

namespace kelp {

// One arc of the center line, of at most 60 degrees, and the slice of the part around it: between two joint
// planes. Its own coordinates are u towards the center of curvature, v across, and the length along the arc.
// Without initial values: hundreds of them are on the stack.
struct Arc {
  glm::vec3 middle;   // of the arc
  float radius;       // of a ball around it that contains the slice
  glm::vec3 along;    // unit: the arc's direction at its middle
  float curvature;    // 1 / the arc's radius, at least 0
  glm::vec3 inward;   // unit, perpendicular to `along`: from the middle to the center of curvature
  float y;            // height at rest of the middle
  glm::vec2 bend;     // unit: a point of the section, x and z from the center line, has u = dot(bend, (x, z))
  float rise;         // height at rest for each length of the arc
  float half_length;  // of the arc
};

// Between two arcs, and at both ends.
struct ArcJoint {
  glm::vec4 plane;  // of the section: dot(plane.xyz, p) + plane.w is 0 on it, positive farther along
  // For normals: these change gradually from joint to joint.
  glm::vec2 curvature;  // in the section's x and z
  float rise;           // as Arc::rise
  float y;              // height at rest
};
static_assert(sizeof(Arc) == 64 && sizeof(ArcJoint) == 32);

inline constexpr int kMaxArcs = 256;
// u times curvature is at most this within the part: nearer to 1 its inner side folds.
inline constexpr double kMostCurved = 0.98;
// The default distance between arcs and spline, in heights of the part. It is an estimate: most arcs are
// nearer, some up to 4.7 times as far.
inline constexpr float kArcTolerance = 1.0f / 1024;

// A posed center line.
struct ArcChain {
  int count;  // of arcs; joint i is before arc i
  Arc arcs[kMaxArcs];
  ArcJoint joints[kMaxArcs + 1];
  glm::vec3 start_x, start_z;  // directions of the section's axes at the first knot
  Box bounds;                  // contains the deformed part
};

// Makes the arcs of a part of `size` voxels. roll: radians, turns the part at its first knot about the
// spline, from x to -z as about +y. tolerance: heights of the part, above 0. kMisuse for what checkPlaces()
// refuses, a zero tangent, two knots on one point, numbers too large, more than kMaxArcs arcs; kFolds where
// the spline turns too sharply for the part's thickness. `offset` is the index of the knot at the place or
// before it. After an error the chain is undefined. Safe for any numbers. Allocates nothing.
Result<void> makeArcs(std::span<const Knot> knots, const glm::ivec3& size, float roll, float tolerance,
                      ArcChain& chain);

// The error of makeArcs() for these knots, at the default tolerance.
Result<void> checkSweep(std::span<const Knot> knots, const glm::ivec3& size, float roll = 0);
// An error if a part that bends so cannot be drawn with these knots: checkKnots() or checkSweep().
Result<void> checkRig(Bend bend, std::span<const Knot> knots, const glm::ivec3& size, float roll = 0);

// The axes and the place of the section at rest height y, from 0 to size.y: columns x, y (along the center
// line), z, origin. Orthonormal, right-handed.
glm::mat4x3 sectionAt(const ArcChain& chain, float y);
// Part space at rest -> part space, swept.
glm::vec3 sweepPoint(const ArcChain& chain, const glm::ivec3& size, const glm::vec3& rest);
// Part space, swept -> at rest. Where coils overlap, the arc with the nearest center line decides. Also maps
// points beside the part's box in x and z. nullopt: the point is in no slice.
std::optional<glm::vec3> unsweepPoint(const ArcChain& chain, const glm::ivec3& size, const glm::vec3& point);

}  // namespace kelp

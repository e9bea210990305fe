// SPDX-License-Identifier: MIT
// Conversions between types of the runtime and of trace.glsl.
#pragma once

#include <cmath>
#include <span>

#include "kelp/formats/sweep.h"
#include "kelp/runtime/instance.h"
#include "trace_cpp.h"

namespace kelp::runtime {

inline bool allFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline glm::mat4 affine(const glm::mat4x3& m) {
  return glm::mat4(glm::vec4(m[0], 0.0f), glm::vec4(m[1], 0.0f), glm::vec4(m[2], 0.0f),
                   glm::vec4(m[3], 1.0f));
}

inline trace::KelpSegment asTrace(const Segment& segment) {
  return {segment.p0, segment.m0, segment.p1, segment.m1};
}

inline trace::KelpArc asTrace(const Arc& a) {
  return {a.middle, a.radius, a.along, a.curvature, a.inward, a.y, a.bend, a.rise};
}
inline trace::KelpJoint asTrace(const ArcJoint& j) { return {j.plane, j.curvature, j.rise, j.y}; }

// For these the part must exist, and the pose must have knots for it.
// The knots of a part as the instance poses it.
std::span<const Knot> knotsOf(const Instance& instance, int part);
// partToWorld().
glm::mat4 matrixOf(const Instance& instance, int part);
// Part space at rest -> object space at rest.
glm::vec3 toObject(const Instance& instance, int part, const glm::vec3& voxels);

// A part with the knots of some pose.
struct PosedPart {
  const Part* part = nullptr;
  std::span<const Knot> knots;  // at least 2, but for parts that a pose does not have
  float roll = 0;               // of a swept part, radians

  bool isSwept() const { return part->bend == Bend::kSweep; }
  // True if the part is drawn with these knots: checkRig().
  Result<void> check() const { return checkRig(part->bend, knots, part->size, roll); }
  // The arcs of a swept part. False: it cannot be drawn.
  bool arcs(ArcChain& chain) const {
    return static_cast<bool>(makeArcs(knots, part->size, roll, kArcTolerance, chain));
  }
};
PosedPart posedPart(const Instance& instance, int part);
PosedPart posedPart(const Part& part, const Pose& pose, int index);
// A box that contains the deformed part, part space. Empty for a swept part that cannot be drawn.
Box boundsOf(const PosedPart& posed);
// Part space at rest -> part space, deformed. Of a swept part that cannot be drawn: as at rest.
glm::vec3 bend(const PosedPart& posed, const glm::vec3& rest);
// The same of a sheared part on these knots.
glm::vec3 shear(std::span<const Knot> knots, const glm::ivec3& size, const glm::vec3& rest);
// True if the part hangs on its parent's spline.
inline bool hangsOnSpline(const Part& part) { return part.parent_at != Part::kNotOnSpline; }

}  // namespace kelp::runtime

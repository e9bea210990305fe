// SPDX-License-Identifier: MIT
// Conversions between types of the runtime and of trace.glsl.
#pragma once

#include <span>

#include "kelp/runtime/instance.h"
#include "trace_cpp.h"

namespace kelp::runtime {

inline glm::mat4 affine(const glm::mat4x3& m) {
  return glm::mat4(glm::vec4(m[0], 0.0f), glm::vec4(m[1], 0.0f), glm::vec4(m[2], 0.0f),
                   glm::vec4(m[3], 1.0f));
}

inline trace::KelpSegment asTrace(const Segment& segment) {
  return {segment.p0, segment.m0, segment.p1, segment.m1};
}

// For these the part must exist, and the pose must have knots for it.
// The knots of a part as the instance poses it.
std::span<const Knot> knotsOf(const Instance& instance, int part);
// Part space at rest -> object space at rest.
glm::vec3 toObject(const Instance& instance, int part, const glm::vec3& voxels);
// Part space at rest -> part space, deformed. `knots`: at least 2.
glm::vec3 bend(const Part& part, std::span<const Knot> knots, const glm::vec3& rest);
// Whether the part hangs on its parent's spline.
inline bool hangsOnSpline(const Part& part) { return part.parent_at != Part::kNotOnSpline; }

}  // namespace kelp::runtime

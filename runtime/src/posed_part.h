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

// The knots of a part as the instance poses it. The part must exist.
std::span<const Knot> knotsOf(const Instance& instance, int part);

}  // namespace kelp::runtime

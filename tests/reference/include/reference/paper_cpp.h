// SPDX-License-Identifier: MIT
// shaders/reference/paper.glsl compiled as C++ with GLM, over a dense volume: the method as published, for
// tests. Include from .cpp files only.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "trace_cpp.h"

namespace kelp::reference {

// One posed part with one segment, and its distance field.
struct PaperContext {
  trace::KelpSegment segment{};
  glm::ivec3 size{0};
  const float* distance = nullptr;  // dense, x fastest: center to center, voxels; 0 in a solid voxel
  float step = 1;                   // the constant step, voxels
};

inline float fetchDistance(const PaperContext& context, glm::ivec3 v) {
  return context.distance[static_cast<std::size_t>(v.x) +
                          static_cast<std::size_t>(context.size.x) *
                              (static_cast<std::size_t>(v.y) +
                               static_cast<std::size_t>(context.size.y) * static_cast<std::size_t>(v.z))];
}

}  // namespace kelp::reference

#define KELP_FN inline
#define KELP_CONTEXT_ const reference::PaperContext &kelp_context,
#define KELP_CONTEXT kelp_context,
#define KELP_SEGMENT(i) kelp_context.segment
#define KELP_SIZE vec3(kelp_context.size)
#define KELP_LEVEL_SIZE kelp_context.size
#define PAPER_FETCH(v) reference::fetchDistance(kelp_context, v)
#define PAPER_STEP kelp_context.step

namespace kelp::paper {
using namespace glm;
using namespace trace;
#include "reference/paper.glsl"
}  // namespace kelp::paper

// The same with the shortcut for S.y by arcsine.
namespace kelp::paper_arcsine {
using namespace glm;
using namespace trace;
#define PAPER_ARCSINE
#include "reference/paper.glsl"
#undef PAPER_ARCSINE
}  // namespace kelp::paper_arcsine

#undef KELP_FN
#undef KELP_CONTEXT_
#undef KELP_CONTEXT
#undef KELP_SEGMENT
#undef KELP_SIZE
#undef KELP_LEVEL_SIZE
#undef PAPER_FETCH
#undef PAPER_STEP

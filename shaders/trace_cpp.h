// SPDX-License-Identifier: MIT
// trace.glsl compiled as C++ with GLM: the CPU queries and the tests run the text that the GPU runs.
// Include it from .cpp files only; it is part of no public interface.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace kelp::trace {

using namespace glm;

struct Context;

#define KELP_FN inline
#define KELP_CONTEXT_ const Context &kelp_context,
#define KELP_CONTEXT kelp_context,
#define KELP_SEGMENTS kelp_context.segment_count
#define KELP_SEGMENT(i) kelp::trace::segmentOf(kelp_context, i)
#define KELP_BOUNDS_MIN kelp_context.bounds_min
#define KELP_BOUNDS_MAX kelp_context.bounds_max
#define KELP_SIZE kelp_context.size
#define KELP_LEVEL_SIZE kelp_context.level_size
#define KELP_LEVEL_SCALE kelp_context.level_scale
#define KELP_FETCH_CELL(v) kelp::trace::fetchCell(kelp_context, v)
#define KELP_FETCH_CODE(k, v) kelp::trace::fetchCode(kelp_context, k, v)

struct KelpSegment;
KelpSegment segmentOf(const Context& context, int i);
uint fetchCell(const Context& context, ivec3 brick);
uint fetchCode(const Context& context, uint slot, ivec3 voxel);

// One level of one posed part: what the macros of trace.glsl read.
struct Context {
  const KelpSegment* segments = nullptr;
  int segment_count = 0;
  vec3 bounds_min{0.0f};
  vec3 bounds_max{0.0f};
  vec3 size{0.0f};
  ivec3 level_size{0};
  float level_scale = 1.0f;
  const std::uint32_t* cells = nullptr;
  ivec3 grid{0};
  const std::uint8_t* codes = nullptr;
};

#include "trace.glsl"

inline KelpSegment segmentOf(const Context& context, int i) { return context.segments[i]; }
inline uint fetchCell(const Context& context, ivec3 v) {
  return context.cells[static_cast<std::size_t>(v.x) + static_cast<std::size_t>(context.grid.x) * (static_cast<std::size_t>(v.y) + static_cast<std::size_t>(context.grid.y) * static_cast<std::size_t>(v.z))];
}
inline uint fetchCode(const Context& context, uint slot, ivec3 v) {
  return context.codes[std::size_t{slot} * 512u + static_cast<std::size_t>((v.x & 7) | ((v.y & 7) << 3) | ((v.z & 7) << 6))];
}

#undef KELP_FN
#undef KELP_CONTEXT_
#undef KELP_CONTEXT
#undef KELP_SEGMENTS
#undef KELP_SEGMENT
#undef KELP_BOUNDS_MIN
#undef KELP_BOUNDS_MAX
#undef KELP_SIZE
#undef KELP_LEVEL_SIZE
#undef KELP_LEVEL_SCALE
#undef KELP_FETCH_CELL
#undef KELP_FETCH_CODE

}  // namespace kelp::trace

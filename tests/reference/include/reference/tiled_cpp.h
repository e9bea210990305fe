// SPDX-License-Identifier: MIT
// trace.glsl compiled as C++ over a TrialVolume, whose bricks may repeat. Include from .cpp files only.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "reference/trials.h"

namespace kelp::reference::tiled {

using namespace glm;

struct KelpSegment;

struct Context {
  const TrialVolume& volume;
  const KelpSegment* segments;
  int segment_count;
  vec3 bounds_min, bounds_max;
};

KelpSegment segmentOf(const Context& context, int i);

inline uint fetchCell(const Context& context, ivec3 brick) {
  const TrialVolume& v = context.volume;
  const ivec3 at = v.first_brick + brick % v.tile_bricks;
  return v.level.cells[static_cast<std::size_t>(at.x) +
                       static_cast<std::size_t>(v.grid.x) *
                           (static_cast<std::size_t>(at.y) +
                            static_cast<std::size_t>(v.grid.y) * static_cast<std::size_t>(at.z))];
}
inline uint fetchCode(const Context& context, uint brick, ivec3 voxel) {
  return context.volume.level
      .codes[std::size_t{brick - 1u} * 512u + static_cast<std::size_t>(codeIndex(voxel))];
}

#define KELP_FN inline
#define KELP_CONTEXT_ const Context &kelp_context,
#define KELP_CONTEXT kelp_context,
#define KELP_SEGMENTS kelp_context.segment_count
#define KELP_SEGMENT(i) segmentOf(kelp_context, i)
#define KELP_BOUNDS_MIN kelp_context.bounds_min
#define KELP_BOUNDS_MAX kelp_context.bounds_max
#define KELP_SIZE vec3(kelp_context.volume.size)
#define KELP_LEVEL_SIZE kelp_context.volume.size
#define KELP_LEVEL_SCALE 1.0f
#define KELP_COMPLETE true
#define KELP_COARSER 0
#define KELP_CELL(v) fetchCell(kelp_context, v)
#define KELP_BRICK(k, cell) ((cell & 0x00ffffffu) + 1u)
#define KELP_BRICK_ABOVE(k, v) 0u
#define KELP_CODE(k, brick, v) fetchCode(kelp_context, brick, v)

#include "spline.glsl"
// After spline.glsl.
#include "curve.glsl"
// After both.
#include "trace.glsl"

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
#undef KELP_COMPLETE
#undef KELP_COARSER
#undef KELP_CELL
#undef KELP_BRICK
#undef KELP_BRICK_ABOVE
#undef KELP_CODE

inline KelpSegment segmentOf(const Context& context, int i) { return context.segments[i]; }

}  // namespace kelp::reference::tiled

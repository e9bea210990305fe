// SPDX-License-Identifier: MIT
// The tracing core compiled as C++ over a TrialVolume, whose bricks may repeat. Include from .cpp files only.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "reference/trials.h"

namespace kelp::reference::tiled {

using namespace glm;

struct KelpSegment;
struct KelpArc;
struct KelpJoint;

struct Context {
  const TrialVolume& volume;
  const KelpSegment* segments;
  int segment_count;
  vec3 bounds_min, bounds_max;
  const KelpArc* arcs = nullptr;  // of a swept part
  const KelpJoint* joints = nullptr;
  int arc_count = 0;
};

KelpSegment segmentOf(const Context& context, int i);
vec4 arcBallOf(const Context& context, int i);
const KelpArc& arcOf(const Context& context, int i);
const KelpJoint& jointOf(const Context& context, int i);

inline uint fetchCell(const Context& context, ivec3 brick) {
  const TrialVolume& v = context.volume;
  const ivec3 at = v.first_brick + brick % v.tile_bricks;
  return v.level.cells[static_cast<std::size_t>(at.x) +
                       static_cast<std::size_t>(v.grid.x) *
                           (static_cast<std::size_t>(at.y) +
                            static_cast<std::size_t>(v.grid.y) * static_cast<std::size_t>(at.z))];
}
inline uint fetchCode(const Context& context, uint brick, ivec3 voxel) {
  if (brick - 1u == (kCellInside & ~kCellSolid)) return kInnerCode;
  return context.volume.level
      .codes[std::size_t{brick - 1u} * 512u + static_cast<std::size_t>(codeIndex(voxel))];
}

#define KELP_FN inline
#define KELP_CONTEXT_ const Context &kelp_context,
#define KELP_CONTEXT kelp_context,
#define KELP_SEGMENTS kelp_context.segment_count
#define KELP_SEGMENT(i) segmentOf(kelp_context, i)
#define KELP_SWEPT (kelp_context.arc_count > 0)
#define KELP_ARCS kelp_context.arc_count
#define KELP_ARC_BALL(i) arcBallOf(kelp_context, i)
#define KELP_ARC(i) arcOf(kelp_context, i)
#define KELP_JOINT_PLANE(i) jointOf(kelp_context, i).plane
#define KELP_JOINT(i) jointOf(kelp_context, i)
#define KELP_BOUNDS_MIN kelp_context.bounds_min
#define KELP_BOUNDS_MAX kelp_context.bounds_max
#define KELP_SIZE vec3(kelp_context.volume.size)
#define KELP_LEVEL_SIZE kelp_context.volume.size
#define KELP_LEVEL_SCALE 1.0f
#define KELP_COMPLETE true
#define KELP_COARSER 0
#define KELP_CELL(v) fetchCell(kelp_context, v)
#define KELP_BRICK(k, cell) ((cell & 0x7fffffffu) + 1u)
#define KELP_BRICK_ABOVE(k, v) 0u
#define KELP_CODE(k, brick, v) fetchCode(kelp_context, brick, v)

#include "spline.glsl"
// After spline.glsl.
#include "curve.glsl"
// After both.
#include "trace.glsl"
// After the three.
#include "arc.glsl"
// After all of them.
#include "sweep.glsl"

#undef KELP_FN
#undef KELP_CONTEXT_
#undef KELP_CONTEXT
#undef KELP_SEGMENTS
#undef KELP_SEGMENT
#undef KELP_SWEPT
#undef KELP_ARCS
#undef KELP_ARC_BALL
#undef KELP_ARC
#undef KELP_JOINT_PLANE
#undef KELP_JOINT
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
inline vec4 arcBallOf(const Context& context, int i) {
  return vec4(context.arcs[i].middle, context.arcs[i].radius);
}
inline const KelpArc& arcOf(const Context& context, int i) { return context.arcs[i]; }
inline const KelpJoint& jointOf(const Context& context, int i) { return context.joints[i]; }

}  // namespace kelp::reference::tiled

// SPDX-License-Identifier: MIT
// The tracing core (spline.glsl, curve.glsl, trace.glsl, arc.glsl, sweep.glsl, cage.glsl, cage_walk.glsl,
// cage_tree.glsl) compiled as C++ with GLM: CPU queries and tests run the text that the GPU runs. Include it
// from .cpp files only; it is not installed.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace kelp::trace {

using namespace glm;

// As GLM's, of which gcc does not inline those for vectors.
using glm::max;
using glm::min;
inline vec3 min(const vec3& a, const vec3& b) {
  return {b.x < a.x ? b.x : a.x, b.y < a.y ? b.y : a.y, b.z < a.z ? b.z : a.z};
}
inline vec3 max(const vec3& a, const vec3& b) {
  return {a.x < b.x ? b.x : a.x, a.y < b.y ? b.y : a.y, a.z < b.z ? b.z : a.z};
}

struct Context;

#define KELP_FN inline
#define KELP_CONTEXT_ const Context &kelp_context,
#define KELP_CONTEXT kelp_context,
#define KELP_SEGMENTS kelp_context.segment_count
#define KELP_SEGMENT(i) kelp::trace::segmentOf(kelp_context, i)
#define KELP_SWEPT (kelp_context.arc_count > 0)
#define KELP_ARCS kelp_context.arc_count
#define KELP_ARC_BALL(i) kelp::trace::arcBallOf(kelp_context, i)
#define KELP_ARC(i) kelp::trace::arcOf(kelp_context, i)
#define KELP_JOINT_PLANE(i) kelp::trace::jointOf(kelp_context, i).plane
#define KELP_JOINT(i) kelp::trace::jointOf(kelp_context, i)
#define KELP_CAGED (kelp_context.cage_words != nullptr)
#define KELP_CAGE_WORD(i) kelp_context.cage_words[i]
#define KELP_NODE(i) kelp_context.nodes[i]
#define KELP_CAGE_LOW(i) kelp_context.cage_boxes[2 * (i)]
#define KELP_CAGE_HIGH(i) kelp_context.cage_boxes[2 * (i) + 1]
#define KELP_CAGE_LEAVES kelp_context.cage_leaves
#define KELP_LEAF_CELL(i) kelp_context.cage_leaf_cells[i]
#define KELP_CAGE_FOLD_LOW kelp_context.fold_min
#define KELP_CAGE_FOLD_HIGH kelp_context.fold_max
#define KELP_LEAF_CELLS 2
#define KELP_BOUNDS_MIN kelp_context.bounds_min
#define KELP_BOUNDS_MAX kelp_context.bounds_max
#define KELP_SIZE kelp_context.size
#define KELP_LEVEL_SIZE kelp_context.level_size
#define KELP_LEVEL_SCALE kelp_context.level_scale
#define KELP_COMPLETE kelp_context.complete
#define KELP_COARSER kelp_context.coarser
#define KELP_CELL(v) kelp::trace::cellAt(kelp_context.levels[0], v)
#define KELP_BRICK(k, cell) kelp::trace::brickOf(kelp_context, k, cell)
#define KELP_BRICK_ABOVE(k, v) kelp::trace::brickAbove(kelp_context, k, v)
#define KELP_CODE(k, brick, v) kelp::trace::codeAt(kelp_context, k, brick, v)

struct KelpSegment;
struct KelpArc;
struct KelpJoint;
struct Level;
KelpSegment segmentOf(const Context& context, int i);
vec4 arcBallOf(const Context& context, int i);
const KelpArc& arcOf(const Context& context, int i);
const KelpJoint& jointOf(const Context& context, int i);
uint cellAt(const Level& level, ivec3 brick);
uint brickOf(const Context& context, int above, uint cell);
uint brickAbove(const Context& context, int above, ivec3 brick);
uint codeAt(const Context& context, int above, uint brick, ivec3 voxel);

// The bricks of one level.
struct Level {
  const std::uint32_t* cells = nullptr;  // x fastest, then y, then z
  ivec3 grid{0};
  // The 512 codes of the brick that a stored cell names; null if it is not resident.
  const std::uint8_t* (*brick)(const void* user, std::uint32_t cell) = nullptr;
  const void* user = nullptr;
};

// A posed part, traced at levels[0], with `coarser` levels above it: what the macros of trace.glsl read.
struct Context {
  const KelpSegment* segments = nullptr;
  int segment_count = 0;
  const KelpArc* arcs = nullptr;  // of a swept part, which needs no segments
  const KelpJoint* joints = nullptr;
  int arc_count = 0;
  // Of a caged part, which needs neither: kelp/cages/posed_cage.h. Without a tree it can only be walked.
  const std::uint32_t* cage_words = nullptr;
  const vec3* nodes = nullptr;
  const vec3* cage_boxes = nullptr;  // of the tree: box i is from 2 i to 2 i + 1
  int cage_leaves = 0;
  const std::uint32_t* cage_leaf_cells = nullptr;  // Cage::leaves
  vec3 fold_min{1.0f};                             // around inverted tetrahedra; min > max: there are none
  vec3 fold_max{-1.0f};
  vec3 bounds_min{0.0f};
  vec3 bounds_max{0.0f};
  vec3 size{0.0f};
  ivec3 level_size{0};
  float level_scale = 1.0f;
  const Level* levels = nullptr;
  int coarser = 0;
  bool complete = true;
};

#include "spline.glsl"
#include "curve.glsl"
#include "trace.glsl"
#include "arc.glsl"
#include "sweep.glsl"
#include "cage.glsl"
#include "cage_walk.glsl"
#include "cage_tree.glsl"

inline KelpSegment segmentOf(const Context& context, int i) { return context.segments[i]; }
inline vec4 arcBallOf(const Context& context, int i) {
  return vec4(context.arcs[i].middle, context.arcs[i].radius);
}
inline const KelpArc& arcOf(const Context& context, int i) { return context.arcs[i]; }
inline const KelpJoint& jointOf(const Context& context, int i) { return context.joints[i]; }
inline uint cellAt(const Level& level, ivec3 v) {
  return level.cells[static_cast<std::size_t>(v.x) +
                     static_cast<std::size_t>(level.grid.x) *
                         (static_cast<std::size_t>(v.y) +
                          static_cast<std::size_t>(level.grid.y) * static_cast<std::size_t>(v.z))];
}
// A brick's handle is its cell's lower 31 bits plus one.
inline const std::uint8_t* codesOf(const Level& level, uint brick) {
  return level.brick(level.user, (brick - 1u) | 0x80000000u);
}
inline uint brickOf(const Context& context, int above, uint cell) {
  const uint brick = (cell & 0x7fffffffu) + 1u;
  return codesOf(context.levels[above], brick) ? brick : 0u;
}
inline uint brickAbove(const Context& context, int above, ivec3 v) {
  const uint cell = cellAt(context.levels[above], v);
  return cell >= 0x80000000u ? brickOf(context, above, cell) : 0u;
}
inline uint codeAt(const Context& context, int above, uint brick, ivec3 v) {
  return codesOf(context.levels[above], brick)[(v.x & 7) | ((v.y & 7) << 3) | ((v.z & 7) << 6)];
}

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
#undef KELP_CAGED
#undef KELP_CAGE_WORD
#undef KELP_NODE
#undef KELP_CAGE_LOW
#undef KELP_CAGE_HIGH
#undef KELP_CAGE_LEAVES
#undef KELP_LEAF_CELL
#undef KELP_CAGE_FOLD_LOW
#undef KELP_CAGE_FOLD_HIGH
#undef KELP_LEAF_CELLS
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

}  // namespace kelp::trace

// SPDX-License-Identifier: MIT
// Posed parts in front of the projection, eight at a time: where they are, how large, whether they are seen,
// and the first texels of their records. The result for a part does not depend on the other seven.
#pragma once

#include "detail.h"
#include "kelp/simd/bound_knots.h"

namespace kelp::draw {

using simd::EightFloats;
using simd::Lanes;

// Whose rays the records are for. kView: the view's own. kAny: a host's shader, whose rays come from
// anywhere; then nothing out of sight is culled, and the records have world -> part space instead of part ->
// clip space.
enum class Rays : std::uint8_t { kView, kAny };

// The first texels of a record: shaders/instance.glsl.
struct RecordHead {
  glm::vec4 to_clip[4];   // rows: part space -> clip space
  glm::vec4 to_world[3];  // rows: part space -> world
  glm::vec4 eye;          // part space; w as in Projection
  glm::vec4 tint;
  glm::vec3 low;           // of the deformed bounds
  std::uint32_t segments;  // or arcs, and kSweptSpline; or nodes, and kCagedSpline
  glm::vec3 high;
  std::uint32_t levels_at;
  glm::vec3 size;
  std::uint32_t detail;
  std::uint32_t palette, instance, part, outline;
};
static_assert(sizeof(RecordHead) == 13 * 16);
inline constexpr std::size_t kHeadTexels = 13;
inline constexpr std::uint32_t kSweptSpline = 0x80000000u;

// Eight parts as the host poses them. The pointers must be valid while this is used.
struct PosedParts {
  std::span<const Knot> knots[8];
  const glm::mat4* to_world[8];  // to_world * to_object takes part space to the world
  const glm::mat4x3* to_object[8];
  const glm::vec4* extents[8];  // ResidentPart::extent

  // Copies the (i - 1)-th to the i-th.
  void repeat(std::size_t i) {
    knots[i] = knots[i - 1], to_world[i] = to_world[i - 1], to_object[i] = to_object[i - 1],
    extents[i] = extents[i - 1];
  }
};

struct PlacedParts {
  simd::EightBoxes bounds;  // deformed, a little enlarged; part space
  EightFloats size[3], levels;
  EightFloats to_clip[4][4];   // rows: part space -> clip space
  EightFloats to_world[3][4];  // rows: part space -> world
  EightFloats eye[3];          // part space; or the direction of view
  EightFloats inside;          // less than 0: outside the view's frustum
  EightFloats nearest;         // clip w of the nearest point; at most 0 where the box reaches behind the eye
  EightFloats pixels;          // that a level-0 voxel covers there; very many if the eye is inside
  // bits: to_world is finite and has an inverse; nothing else here is of use without
  unsigned invertible;
  unsigned affine;    // bits: PosedParts::to_world is affine
  unsigned ordinary;  // bits: float is enough for that inverse
};

struct JudgedParts {
  unsigned seen;       // bits: not culled
  unsigned small;      // bits: in view, and culled because they cover too few pixels
  EightFloats pixels;  // that a level-0 voxel covers, or what that is worth where it is not seen
  EightFloats level;   // Detail::of
};

// Computes the bounds of the parts' splines. Bit i of the result: the knots of part i are monotone and
// finite. Of no use for swept parts: call setBounds() for them, before placeParts().
unsigned boundParts(const PosedParts& parts, PlacedParts& placed);
// Sets the bounds of the i-th part, which must contain it deformed.
void setBounds(const Box& box, const PosedParts& parts, std::size_t i, PlacedParts& placed);

// Computes the rest of `placed`, and the bounds of the parts from those of their splines.
void placeParts(const Projection& projection, const PosedParts& parts, PlacedParts& placed);

void judgeParts(const Projection& projection, const View& view, Rays rays, const PlacedParts& placed,
                JudgedParts& judged);

// The corners of the bounds that draw.vert draws, as instance.glsl stores them: the outline as the eye sees
// it, in the order of a triangle strip. 0: the eye is in the bounds, or too close for an outline in float.
void outlineParts(bool orthographic, const PlacedParts& placed, std::uint32_t (&outlines)[8]);

// Writes matrices, eye, bounds and size. Overwrites the numbers after each corner of the bounds.
void writeHeads(const Projection& projection, const PlacedParts& placed, RecordHead* const (&heads)[8]);

// The level at which a part is drawn whose level-0 voxels cover `pixels`.
Detail detailAt(const View& view, float pixels, int levels);

// True if an affine matrix is finite and invertible.
bool isInvertible(const glm::mat4& matrix);

}  // namespace kelp::draw

// SPDX-License-Identifier: MIT
// Posed parts before the camera, eight side by side: where they are, how large, whether they are seen, and what their records begin with. What comes of a
// part depends neither on the other seven nor on the processor, which computes four or eight at once: kelp/formats/lanes8.h.
#pragma once

#include "detail.h"
#include "kelp/formats/rig_lanes.h"

namespace kelp::gl {

// What the records are for: the view's own rays, or those of a host's shader, which come from anywhere. Then nothing is culled for not being
// before the eye, and the records have world -> part space in place of part -> clip space.
enum class Rays : std::uint8_t { kView, kAny };

// What a record begins with: shaders/instance.glsl.
struct RecordHead {
  glm::vec4 to_clip[4];   // rows: part space -> clip space
  glm::vec4 to_world[3];  // rows: part space -> world
  glm::vec4 eye;          // part space; w as in Camera
  glm::vec4 tint;
  glm::vec3 low;          // of the deformed bounds
  std::uint32_t segments;
  glm::vec3 high;
  std::uint32_t levels_at;
  glm::vec3 size;
  std::uint32_t detail;
  std::uint32_t palette, instance, part, outline;
};
static_assert(sizeof(RecordHead) == 13 * 16);

// Eight parts as the host poses them. Pointers, which must be good while this is used.
struct PosedParts {
  std::span<const Knot> knots[8];
  const glm::mat4* to_world[8];        // to_world * to_object takes part space to the world
  const glm::mat4x3* to_object[8];
  const glm::vec4* extents[8];         // ResidentPart::extent

  // Makes the i-th what the one before it is.
  void repeat(std::size_t i) { knots[i] = knots[i - 1], to_world[i] = to_world[i - 1], to_object[i] = to_object[i - 1], extents[i] = extents[i - 1]; }
};

struct PlacedParts {
  BoxLanes bounds;              // deformed, a little enlarged; part space
  EightFloats size[3], levels;
  EightFloats to_clip[4][4];    // rows: part space -> clip space
  EightFloats to_world[3][4];   // rows: part space -> world
  EightFloats eye[3];           // part space; or the direction of view
  EightFloats inside;           // less than 0: outside the view's frustum
  EightFloats nearest;          // clip w of the nearest point; at most 0 where the box reaches behind the eye
  EightFloats pixels;           // that a level-0 voxel covers there; very many if the eye is inside
  unsigned invertible;          // bits: to_world is finite and has an inverse; nothing else here is of use without
  unsigned affine;              // bits: PosedParts::to_world is affine
  unsigned ordinary;            // bits: float is enough for that inverse
};

struct JudgedParts {
  unsigned seen;                // bits: not culled
  EightFloats pixels;           // that a level-0 voxel covers, or what that is worth where it is not seen
  EightFloats level;            // Detail::of
};

// The bounds of the parts' splines. Bit i: the knots of part i are monotone and finite.
unsigned boundParts(const PosedParts& parts, PlacedParts& placed);

// The rest, and the bounds of the parts from those of their splines.
void placeParts(const Camera& camera, const PosedParts& parts, PlacedParts& placed);

void judgeParts(const Camera& camera, const View& view, Rays rays, const PlacedParts& placed, JudgedParts& judged);

// Which corners of the bounds draw.vert draws, as instance.glsl has them: the outline as the eye sees it, in the order of a triangle strip. 0: the
// eye is in the bounds, or so close that an outline would be lost in rounding.
void outlineParts(bool orthographic, const PlacedParts& placed, std::uint32_t (&outlines)[8]);

// Writes matrices, eye, bounds and size, and whatever lies between or behind the two corners of the bounds.
void writeHeads(const Camera& camera, const PlacedParts& placed, RecordHead* const (&heads)[8]);

// The level at which a part is drawn whose level-0 voxels cover `pixels`.
Detail detailAt(const View& view, float pixels, int levels);

// Whether an affine matrix is finite and invertible.
bool isInvertible(const glm::mat4& matrix);

}  // namespace kelp::gl

// SPDX-License-Identifier: MIT
// Posed parts before the camera, four side by side: where they are, how large, and what begins their records.
#pragma once

#include "detail.h"
#include "kelp/formats/rig_lanes.h"

namespace kelp::gl {

// What a record begins with (shaders/instance.glsl).
struct RecordHead {
  glm::vec4 to_clip[4];   // rows: part space -> clip space
  glm::vec4 to_world[3];  // rows: part space -> world
  glm::vec4 eye;          // part space; w as in Camera
};

struct PlacedParts {
  BoxLanes bounds;        // deformed, a little enlarged; part space
  Lanes eye[3];           // as in the record
  Lanes nearest;          // clip w of the nearest point; at most 0 where the box reaches behind the eye
  Lanes pixels;           // that a level-0 voxel covers there; very many if the eye is inside
  unsigned outside;       // bits: of the view's frustum
  unsigned invertible;    // bits: to_world is finite and has an inverse; nothing else here is of use without
};

// The bounds of four posed parts. Bit i: the knots of part i are monotone and finite.
unsigned boundParts(const std::span<const Knot> (&knots)[4], const glm::ivec3* const (&sizes)[4], PlacedParts& placed);

// The rest, from the bounds.
void placeParts(const Camera& camera, const glm::mat4 (&to_world)[4], PlacedParts& placed, RecordHead* const (&heads)[4]);

// Which corners of the bounds draw.vert draws, as instance.glsl has them: the outline as the eye sees it, in the order of a triangle strip. 0: the
// eye is in the bounds, or so close that an outline would be lost in rounding. Of the bounds' corners, the last lane does not count.
std::uint32_t outlineOf(const glm::vec4& eye, const Lanes& low, const Lanes& high);

// Whether an affine matrix is finite and invertible.
bool isInvertible(const glm::mat4& matrix);

}  // namespace kelp::gl

// SPDX-License-Identifier: MIT
// Which level of detail is drawn: a number between two levels, and a pattern of pixels that draw the one or the other.
#pragma once

#include "kelp/gl/renderer.h"

namespace kelp::gl {

// A View, checked and prepared.
struct Camera {
  glm::dmat4 world_to_clip{1};
  glm::mat4 linear{1};    // the same in float, for all but places
  glm::dvec4 eye{0};      // world; w = 1, or the direction of view and w = 0
  float pixel_scale = 0;  // pixels per unit of length at clip w = 1
};

// kMisuse for a matrix that is not finite or not invertible.
Result<Camera> makeCamera(const View& view);

// The deformed bounds of a posed part, a little enlarged. False: the knots are not monotone or not finite.
bool boundPart(std::span<const Knot> knots, const glm::ivec3& size, Box& bounds);

// A posed part as the camera sees it: what a record begins with (shaders/instance.glsl), and the rest.
struct RecordHead {
  glm::vec4 to_clip[4];   // rows: part space -> clip space
  glm::vec4 to_world[3];  // rows: part space -> world
  glm::vec4 eye;          // part space; w as in Camera
};
struct PlacedPart {
  float nearest;          // clip w of the nearest point; at most 0 where the box reaches behind the eye
  float pixels;           // that a level-0 voxel covers there; very many if the eye is inside
  bool outside;           // of the view's frustum
};
// False, and nothing of use in `head` and `placed`: to_world is not finite or not invertible.
bool placePart(const Camera& camera, const glm::mat4& to_world, const Box& bounds, RecordHead& head, PlacedPart& placed);

// Which corners of the bounds draw.vert draws, as instance.glsl has them: the outline as the eye sees it, in the order of a triangle strip. 0: the
// eye is in the bounds, or so close that an outline would be lost in rounding.
std::uint32_t outlineOf(const glm::vec4& eye, const Box& bounds);

// Whether an affine matrix is finite and invertible.
bool isInvertible(const glm::mat4& matrix);

struct Detail {
  int level = 0;
  int coarser = 0;  // 64ths of the pixels that draw level + 1
};
// The finest level is `finest`, the coarsest `levels` - 1; between them one whose voxels cover about `wanted` pixels.
Detail chooseDetail(float pixels, float wanted, int finest, int levels);

// Whether that pixel draws the coarser level.
bool drawsCoarser(const Detail& detail, const glm::ivec2& pixel);

}  // namespace kelp::gl

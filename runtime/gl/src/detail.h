// SPDX-License-Identifier: MIT
// Which level of detail is drawn: a number between two levels, and a pattern of pixels that draw the one or the other.
#pragma once

#include "kelp/gl/renderer.h"

namespace kelp::gl {

// A View, checked and prepared.
struct Camera {
  glm::dmat4 world_to_clip{1};
  glm::dvec4 eye{0};      // world; w = 1, or the direction of view and w = 0
  double pixel_scale = 0;  // pixels per unit of length at clip w = 1
};

// kMisuse for a matrix that is not finite or not invertible.
Result<Camera> makeCamera(const View& view);

// A posed part as the camera sees it.
struct PlacedPart {
  Box bounds;               // deformed, a little enlarged; part space
  glm::mat4 to_world{1};
  glm::dmat4 to_clip{1};
  glm::dvec4 eye{0};        // part space; w as in Camera
  double nearest = 0;       // clip w of the nearest point; at most 0 where the box reaches behind the eye
  double pixels = 0;        // that a level-0 voxel covers there; very many if the eye is inside
  bool outside = false;     // of the view's frustum
  bool good = false;        // false: to_world is not finite or not invertible
};
PlacedPart placePart(const Camera& camera, const runtime::Instance& instance, int part, std::span<const Knot> knots, const glm::ivec3& size);

// Whether an affine matrix is finite and invertible; `inverse` of its linear part.
bool invert(const glm::mat4& matrix, glm::dmat3& inverse);

struct Detail {
  int level = 0;
  int coarser = 0;  // 64ths of the pixels that draw level + 1
};
// The finest level is `finest`, the coarsest `levels` - 1; between them one whose voxels cover about `wanted` pixels.
Detail chooseDetail(double pixels, float wanted, int finest, int levels);

// Whether that pixel draws the coarser level.
bool drawsCoarser(const Detail& detail, const glm::ivec2& pixel);

}  // namespace kelp::gl

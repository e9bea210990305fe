// SPDX-License-Identifier: MIT
// The view's checks, the projection, and the level of detail: two levels, and a pattern of pixels that draw
// the one or the other.
#pragma once

#include "kelp/draw/view.h"

namespace kelp::draw {

// A View, checked and prepared.
struct Projection {
  glm::dmat4 world_to_clip{1};
  glm::mat4 linear{1};    // the same in float, for all but places
  glm::dvec4 eye{0};      // world; w = 1, or the direction of view and w = 0
  float pixel_scale = 0;  // pixels per unit of length at clip w = 1
};

// kMisuse for a view that draw() and bindTrace() cannot use. features: those of the program.
Result<void> checkView(const View& view, Features features);
// True if the picture is shaded by distances.
inline bool usesDistances(const Quality& quality) { return quality.soft_shadows > 0 || quality.occlusion; }

// kMisuse for a matrix that is not finite or not invertible.
Result<Projection> makeProjection(const View& view);

struct Detail {
  int level = 0;
  int coarser = 0;  // 64ths of the pixels that draw level + 1

  static Detail of(float level) {
    const int parts = static_cast<int>(64.0f * level);  // not below 0
    return {parts >> 6, parts & 63};
  }
};
// True if that pixel draws the coarser level.
bool drawsCoarser(const Detail& detail, const glm::ivec2& pixel);

}  // namespace kelp::draw

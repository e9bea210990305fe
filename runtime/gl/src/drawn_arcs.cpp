// SPDX-License-Identifier: MIT
#include "drawn_arcs.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace kelp::gl {

Box boxOfKnots(std::span<const Knot> knots, const glm::ivec3& size) {
  const glm::vec3 extent(size), half(0.5f * extent.x, 0, 0.5f * extent.z);
  Box box{knots[0].position, knots[0].position};
  for (const Knot& knot : knots) box = {glm::min(box.min, knot.position), glm::max(box.max, knot.position)};
  const float corner = glm::length(half);
  return {half + extent.y * box.min - corner, half + extent.y * box.max + corner};
}

Result<void> makeDrawnArcs(std::span<const Knot> knots, PartKind kind, const glm::ivec3& size, float roll,
                           float level, ArcChain& chain, float& tolerance) {
  if (level >= 1 || kind == PartKind::kFog) {
    // Half a voxel as it is drawn.
    const float half = level >= 1 ? std::ldexp(0.5f, static_cast<int>(std::min(level, 16.0f))) : 0.5f;
    tolerance = std::max(half / static_cast<float>(size.y), kArcTolerance);
    // (Coarse arcs may fold where fine ones do not.)
    if (makeArcs(knots, size, roll, tolerance, chain)) return {};
  }
  tolerance = kArcTolerance;
  return makeArcs(knots, size, roll, tolerance, chain);
}

}  // namespace kelp::gl

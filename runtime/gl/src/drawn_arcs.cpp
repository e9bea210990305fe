// SPDX-License-Identifier: MIT
#include "drawn_arcs.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace kelp::gl {

Box boxOfKnots(std::span<const Knot> knots, const glm::ivec3& size) {
  // The hull of the cubics, and a section's corner around it.
  Box box;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot &k0 = knots[i], &k1 = knots[i + 1];
    const float third = (k1.at - k0.at) / 3;
    for (const glm::vec3& point :
         {k0.position, k0.position + third * k0.tangent, k1.position - third * k1.tangent, k1.position})
      box.add(point);
  }
  const glm::vec3 extent(size), half(0.5f * extent.x, 0, 0.5f * extent.z);
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

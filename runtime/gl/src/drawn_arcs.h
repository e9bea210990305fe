// SPDX-License-Identifier: MIT
// The arcs of swept parts as they are drawn: the farther away, the fewer.
#pragma once

#include "kelp/formats/model.h"
#include "kelp/formats/sweep.h"

namespace kelp::gl {

// About where a swept part is: enough to tell at which level it is drawn. Part space.
Box boxOfKnots(std::span<const Knot> knots, const glm::ivec3& size);

// Makes the arcs of a part that is drawn at about that level, which may be any number: within half a voxel of
// that level from the spline, and those of solids at level 0 as everywhere. `tolerance`: theirs, in heights
// of the part. Fails only where makeArcs() does with the finest tolerance too.
Result<void> makeDrawnArcs(std::span<const Knot> knots, PartKind kind, const glm::ivec3& size, float roll,
                           float level, ArcChain& chain, float& tolerance);

}  // namespace kelp::gl

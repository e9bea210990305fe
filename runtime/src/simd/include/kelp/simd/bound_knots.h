// SPDX-License-Identifier: MIT
// Bounds of posed splines, four rigs at a time.
#pragma once

#include <span>

#include "kelp/formats/spline.h"
#include "kelp/simd/lanes.h"

namespace kelp::simd {

struct EightBoxes {
  EightFloats min[3], max[3];  // voxels
};

// Checks and bounds eight rigs in one pass, of parts that are `heights` voxels high. Bit i of the result is
// set if checkKnots() accepts rig i and its bounds are in `boxes`: those of splineBounds(), plus `margin`
// voxels on every side. If bit i is not set, nothing is known about rig i: call checkKnots() and
// splineBounds() for it. The result for a rig does not depend on the other seven.
[[nodiscard]] unsigned boundKnots(const std::span<const Knot> (&rigs)[8], const EightFloats& heights,
                                  float margin, EightBoxes& boxes);

// deformedBounds() for one rig, several times faster. Its slack for rounding is a little larger.
Box boundKnots(std::span<const Knot> knots, const glm::ivec3& size);

}  // namespace kelp::simd

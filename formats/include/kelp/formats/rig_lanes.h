// SPDX-License-Identifier: MIT
// Eight rigs side by side, for the thousands of a frame. For kelp's libraries; hosts have spline.h.
#pragma once

#include <span>

#include "kelp/formats/lanes.h"
#include "kelp/formats/spline.h"

namespace kelp {

struct BoxLanes {
  EightFloats min[3], max[3];  // voxels
};

// In one pass, whether checkKnots finds nothing wrong with a rig, and deformedBounds of a volume of no size with `margin` voxels on every side. What comes of
// a rig depends neither on the other seven nor on the processor. Bit i: rig i is sound and has its bounds. Without it nothing is said of them, and it takes a
// closer look.
[[nodiscard]] unsigned boundSoundKnots(const std::span<const Knot> (&rigs)[8], float margin, BoxLanes& boxes);

}  // namespace kelp

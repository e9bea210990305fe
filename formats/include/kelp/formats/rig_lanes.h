// SPDX-License-Identifier: MIT
// Four rigs side by side, for the thousands of a frame. For kelp's libraries; hosts have spline.h.
#pragma once

#include <span>

#include "kelp/formats/lanes.h"
#include "kelp/formats/spline.h"

namespace kelp {

struct RigLanes {
  std::span<const Knot> knots[4];
  Lanes size_x, size_z;  // of the volumes, voxels
};
struct BoxLanes {
  Lanes min[3], max[3];  // voxels
};

// In one pass, whether checkKnots finds nothing wrong with a rig, and deformedBounds with `margin` voxels on every side. What comes of a rig does not
// depend on the other three. Bit i: rig i is sound and has its bounds. Without it nothing is said of them, and it takes a closer look.
[[nodiscard]] unsigned boundSoundKnots(const RigLanes& rigs, float margin, BoxLanes& boxes);

}  // namespace kelp

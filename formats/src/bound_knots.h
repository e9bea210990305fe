// SPDX-License-Identifier: MIT
// boundSoundKnots as four and as eight lanes compute it, which is the same.
#pragma once

#include "kelp/formats/lanes8.h"
#include "kelp/formats/rig_lanes.h"

namespace kelp {

// Of the rigs from `first` on; bit i of the answer: of rig first + i.
namespace four {
unsigned boundSoundKnots(const std::span<const Knot> (&rigs)[8], int first, float margin, BoxLanes& boxes);
}
#if defined(KELP_EIGHT_LANES)
namespace eight {
unsigned boundSoundKnots(const std::span<const Knot> (&rigs)[8], int first, float margin, BoxLanes& boxes);
}
#endif

}  // namespace kelp

// SPDX-License-Identifier: MIT
// The steps of placing.h by four and by eight lanes: placing.inl, twice. placing.cpp takes the widest that the processor has; a test compares them.
#pragma once

#include "placing.h"

namespace kelp::gl {

// Each works on the parts from `first` on, as many as it has lanes. Bits are added to what is there.
struct PlacingSteps {
  int lanes;
  void (*place)(const Camera& camera, const PosedParts& parts, int first, PlacedParts& placed);
  void (*judge)(const Camera& camera, const View& view, Rays rays, int first, const PlacedParts& placed, JudgedParts& judged);
  void (*findSides)(bool orthographic, const PlacedParts& placed, int first, EightFloats& sides);
  void (*writeHeads)(const Camera& camera, int first, const PlacedParts& placed, RecordHead* const (&heads)[8]);
};

const PlacingSteps& fourLanes();
// Of this processor: eight, or four.
const PlacingSteps& widestLanes();

}  // namespace kelp::gl

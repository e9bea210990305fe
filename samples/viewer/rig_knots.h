// SPDX-License-Identifier: MIT
// Knots that come and go. Waves and keys name knots by index: theirs follow.
#pragma once

#include "kelp/rig_json/rig_json.h"

namespace viewer {

bool movesKnot(kelp::Target target);

// A knot half way between `after` and the next, on the spline, with waves of its own, so that nothing looks other than before; keys it gets none.
void insertKnot(kelp::RigDescription& rig, int after);
// With what moves it; a clip that moves nothing else goes too. Not for the first and the last.
void removeKnot(kelp::RigDescription& rig, int knot);

// The preset "sway" for whatever knots there are: the first stands, the others swing as a beam bends, the more the farther up.
kelp::RigDescription::Clip swayOf(const kelp::RigDescription& rig, const std::string& name);

}  // namespace viewer

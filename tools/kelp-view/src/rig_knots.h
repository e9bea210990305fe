// SPDX-License-Identifier: MIT
// How a part bends, adding and removing knots, and new sockets. Waves and keys name knots by index; their
// indices follow.
#pragma once

#include "kelp/rig/rig.h"

namespace kelp::view {

bool movesKnot(Target target);

// A part that becomes sheared loses its roll. caged: with a cage; the bend is kSweep then.
void bendAs(RigDescription& rig, Bend bend, bool caged = false);

// Adds a knot on the spline, half way between `after` and the next, with waves of its own, so that the motion
// stays the same. It gets no keys.
void insertKnot(RigDescription& rig, int after);
// Removes a knot, and the waves and keys that move it; also a clip that moves nothing else. Not for the first
// and the last knot.
void removeKnot(RigDescription& rig, int knot);

// A socket at the tip, with a name that no other has.
RigDescription::Socket newSocket(const RigDescription& rig);
// The share of an offset that lies across the rig's axis, where sockets may go.
glm::vec3 acrossAxis(const RigDescription& rig, const glm::vec3& offset);

// The preset "sway" for any knots: the first stands still, the others swing as a beam bends, more towards the
// tip.
RigDescription::Clip swayOf(const RigDescription& rig, const std::string& name);

}  // namespace kelp::view

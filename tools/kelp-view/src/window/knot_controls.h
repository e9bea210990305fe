// SPDX-License-Identifier: MIT
// A knot of the rig panel: its place, its tangent, and buttons that add and remove knots.
#pragma once

#include "window/rig_widgets.h"

namespace kelp::view {

// Draws the controls of one knot; what the user does changes the draft.
void drawKnot(Draft& draft, int index);

}  // namespace kelp::view

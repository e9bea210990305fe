// SPDX-License-Identifier: MIT
// How a part bends: sheared or swept, and the roll.
#pragma once

#include "window/rig_widgets.h"

namespace kelp::view {

// Draws the controls; what the user does changes the draft.
void drawBend(Draft& draft);

}  // namespace kelp::view

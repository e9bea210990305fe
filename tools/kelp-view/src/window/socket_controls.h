// SPDX-License-Identifier: MIT
// The sockets of a rig: their names, places and rotations.
#pragma once

#include "window/rig_widgets.h"

namespace kelp::view {

// All sockets, and a button that adds one.
void drawSockets(Draft& draft);

}  // namespace kelp::view

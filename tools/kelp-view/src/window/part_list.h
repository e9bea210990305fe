// SPDX-License-Identifier: MIT
// The parts in the panel: a list and, where the picture shows parts, their colours, the scale of the fit, and
// what is known of one of them.
#pragma once

#include "window/stage.h"

namespace kelp::view {

// The user may choose a part, or point at it.
void drawPartList(const Stage& stage, PartFocus& focus);
// Below the choice of colours; nothing where the picture does not show parts.
void drawPartNumbers(const Stage& stage, const PartFocus& focus);

}  // namespace kelp::view

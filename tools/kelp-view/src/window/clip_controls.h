// SPDX-License-Identifier: MIT
// The clips of the rig panel: which one, its waves and its keys.
#pragma once

#include "travelling_wave.h"
#include "window/rig_widgets.h"

namespace kelp::view {

// What the panel remembers of its clips from frame to frame.
struct ClipPanel {
  int clip = 0;  // the one that is edited
  TravellingWave wave{{0.02f, 0, 0}, {0.15f, 0, 0}, 2, 1};
  std::string play;  // asks that this clip be played alone
};

// The list of clips, with buttons that add one and remove one.
void drawClipChoice(Draft& draft, ClipPanel& panel);
// The clip that was chosen. `now`: the second that the clips are at.
void drawClip(Draft& draft, ClipPanel& panel, double now);

}  // namespace kelp::view

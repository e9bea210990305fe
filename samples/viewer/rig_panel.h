// SPDX-License-Identifier: MIT
// The window on the right: knots, tangents, waves and keys as numbers.
#pragma once

#include <functional>
#include <string>

#include "rig_editor.h"
#include "travelling_wave.h"

namespace viewer {

// What the panel remembers from frame to frame.
struct RigPanel {
  int part = 0, clip = 0;
  std::string path;     // where Save writes
  std::string said;     // the answer to the last thing that was done
  bool refused = false;  // whether it is bad news
  TravellingWave wave{{0.02f, 0, 0}, {0.15f, 0, 0}, 2, 1};
  bool closed = false;   // asks to be closed
  std::string play;      // asks that this clip be played alone
};

// Draws it; changes go to the editor at once. `save` writes the part's rig to panel.path. `now`: the second that the clips are at.
void drawRigPanel(RigPanel& panel, RigEditor& editor, double now, const std::function<void()>& save);

}  // namespace viewer

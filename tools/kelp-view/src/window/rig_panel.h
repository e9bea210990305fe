// SPDX-License-Identifier: MIT
// The window on the right: knots, tangents, waves and keys as numbers.
#pragma once

#include <functional>
#include <string>

#include "rig_editor.h"
#include "window/rig_controls.h"

namespace kelp::view {

// The panel's state from frame to frame.
struct RigPanel {
  int part = 0;  // the one that is edited
  ClipPanel clips;
  std::string path;      // where Save writes
  std::string said;      // the answer to the last action
  bool refused = false;  // the answer is an error
  bool closed = false;   // the user has closed the panel
};

// Draws the panel. Changes go to the editor at once. `save` writes the part's rig to panel.path. `now`: the
// second that the clips are at.
void drawRigPanel(RigPanel& panel, RigEditor& editor, double now, const std::function<void()>& save);

}  // namespace kelp::view

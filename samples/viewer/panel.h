// SPDX-License-Identifier: MIT
// What the viewer says and asks: the panel on the left, and the splines and handles over the picture.
#pragma once

#include <optional>
#include <string>

#include "handles.h"
#include "stage.h"
#include "workshop.h"

namespace viewer {

// What the user has chosen.
struct Choices {
  bool play = true;
  double seconds = 0;
  float pixels_per_voxel = 1;  // 0: always the finest level
  bool handles = true;
  bool edit = false;  // the rig editor is open: what is dragged changes the rig
};

// What there is to say.
struct Status {
  const Workshop* workshop = nullptr;
  bool unsaved = false;
  std::string notice;  // in passing
  std::string wrong;   // in red
};

// Draws the panel; may change the choices, the clips' weights, what was dragged and the surface.
void drawPanel(Stage& stage, Choices& choices, const std::optional<kelp::runtime::Hit>& under_mouse, Status& status);

// Draws every spline and its handles; `lit` is the handle that the mouse is at or holds.
void drawHandles(const Model& model, const OrbitCamera& camera, const std::optional<Handle>& lit);

}  // namespace viewer

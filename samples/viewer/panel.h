// SPDX-License-Identifier: MIT
// What the viewer says and asks: the panel on the left, and the splines and handles over the picture.
#pragma once

#include <optional>
#include <string>

#include "handles.h"
#include "stage.h"

namespace viewer {

// What the user has chosen.
struct Choices {
  bool play = true;
  double seconds = 0;
  float pixels_per_voxel = 1;  // 0: always the finest level
  bool handles = true;
};

// Draws the panel; may change the choices, the clips' weights, the edits and the surface. `wrong` is shown in red, unless empty.
void drawPanel(Stage& stage, Choices& choices, const std::optional<kelp::runtime::Hit>& under_mouse, std::string& wrong);

// Draws every spline and its handles; `lit` is the handle that the mouse is at or holds.
void drawHandles(const Model& model, const OrbitCamera& camera, const std::optional<Handle>& lit);

}  // namespace viewer

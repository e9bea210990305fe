// SPDX-License-Identifier: MIT
// The panel on the left, and what lies over the picture: splines and handles.
#pragma once

#include <optional>
#include <string>

#include <imgui.h>

#include "handles.h"
#include "window/stage.h"
#include "workshop.h"

namespace kelp::view {

inline const ImVec4 kBad{1, 0.45f, 0.4f, 1}, kGood{0.55f, 0.85f, 0.5f, 1}, kUnsaved{1, 0.8f, 0.3f, 1};

// The user's choices.
struct Choices {
  bool play = true;
  double seconds = 0;
  float pixels_per_voxel = 1;  // 0: always the finest level
  bool handles = true;
  bool edit = false;  // the rig editor is open: what is dragged changes the rig
};

// Messages that the panel shows.
struct Status {
  const Workshop* workshop = nullptr;
  bool unsaved = false;
  std::string notice;
  std::string wrong;  // in red
};

// Draws the panel. The user may change the choices, the clips' weights, the handles and the surface.
void drawPanel(Stage& stage, Choices& choices, const std::optional<runtime::Hit>& under_mouse,
               Status& status);

// Draws every spline and its handles. `lit`: the handle that the mouse points at or holds.
void drawHandles(const Model& model, const OrbitCamera& camera, const std::optional<Handle>& lit,
                 std::span<const RawSocket> sockets);

}  // namespace kelp::view

// SPDX-License-Identifier: MIT
// The panel on the left, and the splines and handles over the picture.
#pragma once

#include <optional>
#include <string>

#include "handles.h"
#include "window/stage.h"
#include "workshop.h"

namespace kelp::view {

// The user's choices.
struct Choices {
  bool play = true;
  double seconds = 0;
  float pixels_per_voxel = 1;  // 0: always the finest level
  bool handles = true;
  bool joints = false;
  PartFocus focus;
  bool edit = false;  // the rig editor is open: what is dragged changes the rig
};

// Whether handles are drawn and can be held. Where the picture shows parts they would hide them, so there
// they belong to the rig editor.
inline bool showsHandles(const Choices& choices, Surface surface) {
  return choices.handles && (choices.edit || !showsParts(surface));
}

// Changes what the colours mean. Where the picture begins to show parts, it shows joints too. Answers an
// empty text, or what is wrong.
std::string changeSurface(Stage& stage, Choices& choices, Surface surface);

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

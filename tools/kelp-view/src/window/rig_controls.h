// SPDX-License-Identifier: MIT
// The controls of the rig panel. What the user does changes the draft.
#pragma once

#include <cstddef>
#include <string>

#include "kelp/rig/rig.h"
#include "waves.h"

namespace kelp::view {

constexpr float kLengthsPerPixel = 0.002f;  // how far a drag by one pixel changes a length

// A copy of the rig that the controls change. The editor checks it once, after all of them are drawn.
struct Draft {
  RigDescription rig;
  bool changed = false;
};

// Names as the panel shows them, in the order of kelp::Target and kelp::Interpolation.
extern const char* const kTargetNames[5];
extern const char* const kInterpolationNames[3];

// Small controls; each answers true if the user changed the value.
// A tooltip for the control before it. It stands beside the window, where it hides no number.
void tip(const char* text);
// A button that is gray and dead unless it is `enabled`.
bool button(const char* label, bool enabled);
bool choose(const char* label, int& index, const char* const* names, int count, float width);
bool chooseKnot(const char* label, int& knot, std::size_t knots);
bool dragLengths(const char* label, glm::vec3& v);
bool dragNumber(const char* label, float& v, float speed, float least, float most, const char* format);

// How the part bends: sheared or swept, and the roll.
void drawBend(Draft& draft);
// One knot: its place, its tangent, and buttons that add and remove knots.
void drawKnot(Draft& draft, int index);
// All sockets, and a button that adds one.
void drawSockets(Draft& draft);

// The panel's state of its clips from frame to frame.
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

// SPDX-License-Identifier: MIT
// Small controls that the rig panel is made of. Each answers whether the user changed the value.
#pragma once

#include <cstddef>

#include "kelp/rig/rig.h"

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

// A tooltip for the control before it. It stands beside the window, where it hides no number.
void tip(const char* text);
// A button that is grey and dead unless it is `enabled`.
bool button(const char* label, bool enabled);
bool choose(const char* label, int& index, const char* const* names, int count, float width);
bool chooseKnot(const char* label, int& knot, std::size_t knots);
bool dragLengths(const char* label, glm::vec3& v);
bool dragNumber(const char* label, float& v, float speed, float least, float most, const char* format);

}  // namespace kelp::view

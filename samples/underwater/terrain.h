// SPDX-License-Identifier: MIT
// The shape of the place: how high the sand lies, where the glade is that the camera circles in, where the
// water ends.
#pragma once

#include <glm/glm.hpp>

namespace underwater {

inline constexpr float kReefRadius = 11;    // meters: plants grow within
inline constexpr float kGladeRadius = 4;    // meters: the middle, where only low plants grow
inline constexpr float kCameraRing = 3.6f;  // meters from the middle, more or less: where the camera circles
inline constexpr float kSurface = 7;        // meters: height of the water's surface

// Height of the sand at (x, z), meters: dunes, within half a meter of 0. The ripples are left to the shader.
float sandHeight(const glm::vec2& at);
// Unit, upward.
glm::vec3 sandNormal(const glm::vec2& at);

// Smooth, in [0, 1]: where the tall plants stand close.
float groveDensity(const glm::vec2& at);
// Smooth, in [0, 1]: where hardly anything grows.
float bareSand(const glm::vec2& at);

}  // namespace underwater

// SPDX-License-Identifier: MIT
// The water that moves.
#pragma once

#include <glm/glm.hpp>

namespace underwater {

// How far the water leans what grows at a place (x, z), in x and z, at a time: heights, at most 0.26. A swell
// that rolls over the reef.
glm::vec2 currentAt(const glm::vec2& at, double seconds);

}  // namespace underwater

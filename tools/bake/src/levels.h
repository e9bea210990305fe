// SPDX-License-Identifier: MIT
#pragma once

#include "kelp/bake/bake.h"

namespace kelp::bake {

// Levels of a volume: down to a single brick, or `asked` if that is fewer (0: all).
int levelCount(const glm::ivec3& size, int asked);

// The look of a fog part: white, scattering equally to all sides. Where there is heat, it glows in the colors
// of `ramp`, or of a black body if `ramp` is empty. It is as bright as the ramp where both heat and density
// are greatest.
RawFog fogLook(const FogGrid& grid, const std::vector<glm::vec3>& ramp);

}  // namespace kelp::bake

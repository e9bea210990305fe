// SPDX-License-Identifier: MIT
#pragma once

#include "kelp/bake/bake.h"

namespace kelp::bake {

// What the samples of a fog part mean: white, turned equally to all sides; where there is heat, it glows in
// the colours of `ramp` or, without any, of a black body, as bright as the ramp where both heat and density
// are greatest.
RawFog fogLook(const FogGrid& grid, const std::vector<glm::vec3>& ramp);

}  // namespace kelp::bake

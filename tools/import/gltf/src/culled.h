// SPDX-License-Identifier: MIT
// Surfaces that viewers never show: outlines for toon shading, and skies.
#pragma once

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Removes closed components that are turned inside out, whose materials have one side, and that stand around
// something that is seen: from outside, a viewer culls all of their faces. Not the inner face of a wall: that
// is within a closed component that is right. Each makes a notice. Parts may lose all of their triangles.
void removeCulled(SourceModel& model);

}  // namespace kelp::bake

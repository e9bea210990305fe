// SPDX-License-Identifier: MIT
// Surfaces that viewers never show: outlines for toon shading, and skies.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Removes closed components that are turned inside out, whose materials have one side, and that stand around
// something that is seen: from outside, a viewer culls all of their faces. Not the inner face of a wall: that
// is within a closed component that is right. Those of one material make a notice. Parts may lose all of
// their triangles.
void removeCulled(std::span<SourcePart> parts, const std::vector<SurfaceMaterial>& materials,
                  std::vector<std::string>& notices);

}  // namespace kelp::bake

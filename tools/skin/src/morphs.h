// SPDX-License-Identifier: MIT
// Morph targets as empty parts whose translations along x are their weights.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kelp/import/core/source_model.h"
#include "kelp/skin/skin.h"

namespace kelp::bake {

// The morph targets of the skin that move a node, with their clips: at each time that a clip was sampled at,
// the keys of all weights together take every node to within `tolerance` (voxels) of where the weights do. A
// notice names the others. `moves`, `fits`: of each target of the skin.
std::vector<SkinMorph> morphsOfSkin(const SourceSkin& skin, std::vector<RawMorph> moves,
                                    std::vector<SkinFit> fits, double tolerance,
                                    std::vector<std::string>& notices);

}  // namespace kelp::bake

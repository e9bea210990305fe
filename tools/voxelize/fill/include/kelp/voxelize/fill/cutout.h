// SPDX-License-Identifier: MIT
// Cards with pictures of leaves become leaves.
#pragma once

#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/look.h"

namespace kelp::bake {

// Empties the voxels that are solid for the sake of sheets alone (kKept) where every sheet that passes
// through them is cut out.
void cutOutVoxels(const SurfaceLook& look, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake

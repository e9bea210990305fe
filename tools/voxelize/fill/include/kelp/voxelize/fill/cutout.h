// SPDX-License-Identifier: MIT
// Alpha cut-outs: a flat card with a picture of leaves becomes leaves.
#pragma once

#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/look.h"

namespace kelp::bake {

// Empties a voxel that is solid only because of sheets (kKept) if every sheet that passes through it is cut
// out there (SurfaceLook::isCutOut).
void cutOutVoxels(const SurfaceLook& look, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake

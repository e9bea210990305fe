// SPDX-License-Identifier: MIT
// Closes gaps through which a ray could pass a sheet.
#pragma once

#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// If two voxels of a thin part touch only along an edge, a ray through that edge passes between them, because
// tracing is exact only to 1/256 voxel. Where the mesh passes such an edge, the nearer of the two empty
// voxels beside the edge becomes kKept.
void closeDiagonalGaps(const Topology& mesh, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                       std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake

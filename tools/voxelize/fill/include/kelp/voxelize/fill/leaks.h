// SPDX-License-Identifier: MIT
// No ray slips through a sheet.
#pragma once

#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// Where two voxels of a thin part touch along an edge alone, a ray that aims at the edge passes: it may miss
// a voxel by 1/256 (DESIGN 3.5). Where the mesh runs by such an edge, the one of the two empty voxels beside
// it that the mesh is nearer to becomes kKept.
void closeDiagonalGaps(const Topology& mesh, const TriangleBvh& bvh,
                       const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                       std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake

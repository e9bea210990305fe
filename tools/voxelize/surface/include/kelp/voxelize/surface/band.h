// SPDX-License-Identifier: MIT
// The voxels near triangles, by OpenVDB's mesh voxelizer.
#pragma once

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// The voxels whose centre is within half a voxel's diagonal of a triangle that is not a cap. These include
// all voxels that a triangle passes through. Dense indices, ascending, the same with any number of threads.
// Throws ToolError kRuntime if OpenVDB fails.
std::vector<std::uint64_t> touchedVoxels(const Topology& mesh, const glm::ivec3& size, int threads);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// The voxels that triangles come near, from OpenVDB's mesh voxelizer. The only file of the fill that includes
// OpenVDB is surface_band.cpp.
#pragma once

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// Voxels whose centre lies within half a voxel's diagonal of a triangle that is not a cap, hence all that a
// triangle passes through; as dense indices, ascending. The same for any number of threads. ToolError
// kRuntime if OpenVDB fails.
std::vector<std::uint64_t> touchedVoxels(const Topology& mesh, const glm::ivec3& size, int threads);

}  // namespace kelp::bake

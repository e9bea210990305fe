// SPDX-License-Identifier: MIT
// Numbers of a mesh for the report.
#pragma once

#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/topology/fill_report.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// Counts the mesh as in the file. Takes 24 bytes for each triangle and 8 for each vertex while it runs.
MeshCounts countMesh(const TriangleSoup& soup, int threads = 1);
// All of FillCounts except kept_voxels. `triangles`: of the mesh in the file.
FillCounts countFill(const Topology& mesh, std::uint64_t triangles);

}  // namespace kelp::bake

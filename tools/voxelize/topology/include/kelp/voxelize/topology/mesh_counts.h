// SPDX-License-Identifier: MIT
// Numbers of a mesh for the report.
#pragma once

#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/topology/fill_report.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// The mesh as the file has it. Takes 24 bytes a triangle while it counts.
MeshCounts countMesh(const TriangleSoup& soup);
// What became of a mesh of `triangles` triangles; all but the voxels.
FillCounts countFill(const Topology& mesh, std::uint64_t triangles);

}  // namespace kelp::bake

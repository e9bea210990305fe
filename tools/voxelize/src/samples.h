// SPDX-License-Identifier: MIT
// Normal and material of surface voxels, from the nearest point of the mesh.
#pragma once

#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/fill/fill.h"
#include "kelp/voxelize/surface/look.h"

namespace kelp::bake {

// One sample a surface voxel (`surface`, ascending dense indices). Normals are the gradient of the signed
// distance, taken from the exact nearest point; on sheets the triangle's normal as wound, turned for a sheet
// as a whole if a body lies before it. Colors never come from the cap of a hole, nor from where a sheet is
// cut out if another passes through the voxel.
std::vector<SurfaceSample> sampleSurface(const SurfaceLook& look, const Topology& mesh,
                                         const TriangleBvh& bvh, const std::vector<std::uint8_t>& voxels,
                                         const glm::ivec3& size, const std::vector<std::uint64_t>& surface,
                                         int threads, const Step& step);

}  // namespace kelp::bake

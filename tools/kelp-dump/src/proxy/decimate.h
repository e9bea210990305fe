// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "proxy/proxy_mesh.h"
#include "proxy/surface_distance.h"
#include "proxy/voxel_surface.h"

namespace kelp::dump {

// Takes vertices out of the surface, by OpenMesh's decimater (error quadrics, bounded normals), as long as no
// point of a triangle is farther than `most` voxels from the faces, and no point of a face farther than that
// from the triangles. Stays closed and manifold.
ProxyMesh decimate(const VoxelSurface& surface, const std::vector<VoxelFace>& faces,
                   const SurfaceDistance& distance, double most);

}  // namespace kelp::dump

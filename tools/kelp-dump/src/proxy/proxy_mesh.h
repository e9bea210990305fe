// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <glm/mat4x3.hpp>

#include "pack/level_voxels.h"
#include "proxy/mesh_distance.h"

namespace kelp::dump {

using ProxyMesh = OpenMesh::TriMesh_ArrayKernelT<>;

// The surface of the solid voxels by marching cubes, in voxels: closed and manifold wherever voxels touch, at
// most 0.6 voxels from their faces. Solid voxels that share no face are kept apart.
ProxyMesh surfaceOf(const LevelVoxels& level);
// Smooths by OpenMesh's Laplace smoother: at most `most` voxels along the normal.
void smooth(ProxyMesh& mesh, double most);
// Collapses edges as long as no vertex of the mesh as it was is farther than `most` from what is left.
void decimate(ProxyMesh& mesh, double most);

std::vector<Triangle> trianglesOf(const ProxyMesh& mesh);
// Maps the points; turns the triangles if the map mirrors.
ProxyMesh mapped(const ProxyMesh& mesh, const glm::dmat4x3& map);
// As a file of a format, by OpenMesh: ".obj" and ".off" as text with all digits of a float, ".ply" and ".stl"
// in binary. ToolError kRuntime if OpenMesh refuses.
std::string encodeMesh(const ProxyMesh& mesh, const std::string& extension);

}  // namespace kelp::dump

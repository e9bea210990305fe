// SPDX-License-Identifier: MIT
// OpenMesh's half-edge mesh, as the baker uses it.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <glm/glm.hpp>

namespace kelp::bake {

// Handles are indices, so that whatever goes through them in order is the same everywhere.
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

inline OpenMesh::Vec3d toPoint(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
inline glm::dvec3 pointOf(const HalfEdgeMesh& mesh, OpenMesh::VertexHandle vertex) {
  const OpenMesh::Vec3d& p = mesh.point(vertex);
  return {p[0], p[1], p[2]};
}

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// The half-edge mesh of what is not sound: components with an edge that is not between two triangles which
// run along it in opposite senses.
#pragma once

#include <cstdint>
#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "edges.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// Handles are indices, so that whatever goes through them in order is the same everywhere.
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

// Every triangle of these components is a face, in the mesh's order; every side of one is a half-edge.
struct FaultyMesh {
  HalfEdgeMesh half_edges;
  std::vector<std::uint32_t> vertices;   // of each vertex: the mesh's; several stand for one
  std::vector<std::uint32_t> triangles;  // of each face: the mesh's
};

// Winds the triangles of faulty components and makes their half-edge mesh. `edges`: all of the mesh, walls
// apart, as the file winds them. Fills the components' diagnosis but for the holes.
//  - Triangles joined by edges of exactly two are wound in one sense: that of the larger part of their area.
//  - What has one side (a Moebius strip) is cut: where two triangles run along their edge in the same sense,
//    it becomes two edges of one.
//  - An edge of more triangles becomes edges of two that run along it in opposite senses, in the mesh's
//    order; what is left over is open. So no edge is open that need not be.
//  - A vertex stands for triangles around a point that hang together by edges there: several where a bow-tie
//    or an edge was split.
// Source: Gueziec, Taubin, Lazarus, Horn, "Cutting and Stitching: Converting Sets of Polygons to Manifold
// Surfaces", 2001. Deviation: only the edges above are cut.
FaultyMesh makeFaultyMesh(Topology& mesh, std::vector<Edge> edges);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// The half-edge mesh of what is not sound: components with an edge that is not between two triangles which
// run along it in opposite senses. Its boundary loops, and the fans that close them.
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

// A loop that passes through each vertex of the mesh once, wound as the triangles that close it.
struct Hole {
  std::uint32_t component = 0;
  std::vector<std::uint32_t> corners;  // vertices of the mesh
};

// The open half-edges, each once, by component. They are walked from vertex to vertex of the mesh, not round
// the triangles of one half-edge vertex: where two holes touch, that walk would change from one to the other.
// A loop is cut off where the walk comes back to a vertex: holes that touch are two, and a fan for each is
// much smaller than one for both. Counts them in the components' diagnosis.
std::vector<Hole> findHoles(Topology& mesh, const FaultyMesh& faulty);

// A fan over each hole, around the centroid of its loop. The centroid is added to the mesh's vertices.
std::vector<SolidTriangle> makeFans(Topology& mesh, const std::vector<Hole>& holes);

}  // namespace kelp::bake

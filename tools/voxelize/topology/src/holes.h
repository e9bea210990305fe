// SPDX-License-Identifier: MIT
// Boundary loops of the half-edge mesh, and the fans that close them.
#pragma once

#include <cstdint>
#include <vector>

#include "faulty_mesh.h"

namespace kelp::bake {

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

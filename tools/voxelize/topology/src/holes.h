// SPDX-License-Identifier: MIT
// Boundary loops of the half-edge mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "faulty_mesh.h"

namespace kelp::bake {

// A loop that passes through each vertex of the mesh once, as a cap runs along it.
struct Hole {
  std::uint32_t component = 0;
  std::vector<std::uint32_t> corners;  // vertices of the mesh
  std::vector<glm::dvec3> normals;     // at each: the sum of the area vectors of the triangles around
  std::uint32_t apex = 0;              // of its cone; set with that

  // as seen from the other side
  void turn();
};

// The open half-edges, each once, by component. They are walked from vertex to vertex of the mesh: round the
// triangles of one half-edge vertex alone the walk would change from one hole to another where two touch.
// What comes back to a vertex is cut off there: holes that touch are two, and a cone for each is much smaller
// than one for both. Counts them in the components' diagnosis.
std::vector<Hole> findHoles(Topology& mesh, const FaultyMesh& faulty);

}  // namespace kelp::bake

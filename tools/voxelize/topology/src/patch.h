// SPDX-License-Identifier: MIT
// A disc of triangles across a polygon in space.
#pragma once

#include <cstdint>
#include <span>

#include "half_edge_mesh.h"

namespace kelp::bake {

// Triangles that span a closed polygon; its corners are the first `rim` vertices, in their order. Wound as
// the polygon runs.
struct Patch {
  HalfEdgeMesh mesh;
  std::uint32_t rim = 0;
};

// The triangulation of least area, refined until its triangles are about as small as the polygon's edges,
// which should be of one length. At least 3 corners; the time grows with the cube of their number. Sources:
// Barequet, Sharir, "Filling Gaps in the Boundary of a Polyhedron", 1995; Liepa, "Filling Holes in Meshes",
// 2003, section 3. Deviations: the weight is the area alone, for the triangulation only has to be a disc that
// fairing shapes; and one size of triangle everywhere.
Patch spanPolygon(std::span<const glm::dvec3> polygon);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Holes are closed.
#pragma once

#include <span>
#include <vector>

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// An edge that is not closed, as a cap runs along it.
struct BoundaryEdge {
  std::uint32_t component = 0, from = 0, to = 0;
};

// The cones over every component's boundary, which must be sorted by component and be a cycle in each. It is
// taken apart into holes, loops that pass through each vertex once. The cones of a hole are adjacent; corner
// 2 of each is its apex, which is added to the mesh.
std::vector<SolidTriangle> makeCones(Topology& mesh, std::span<const BoundaryEdge> boundary);

// Adds the caps of solid components to the mesh: the cones, but for holes that are large beside their
// component and seem to be torn into a body that bulged there. Those get a cap that goes on as the surface
// around does. Bodies that are inside out have been turned before.
void addCaps(Topology& mesh, std::vector<SolidTriangle> cones);

}  // namespace kelp::bake

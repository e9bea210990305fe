// SPDX-License-Identifier: MIT
// Holes are closed.
#pragma once

#include <vector>

#include "holes.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// The cones over holes, each from its centroid, which is added to the mesh as corner 2 of the cone's
// triangles and as the hole's apex.
std::vector<SolidTriangle> makeCones(Topology& mesh, std::vector<Hole>& holes);

// Adds the caps of solid components to the mesh: the cones, but for holes that are large beside their
// component and seem to be torn into a body that bulged there. Those get a cap that goes on as the surface
// around does. Bodies that are inside out have been turned before.
void addCaps(Topology& mesh, std::vector<Hole> holes);

}  // namespace kelp::bake

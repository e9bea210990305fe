// SPDX-License-Identifier: MIT
// Triangles that snapping has made lines and points of: the wires and specks that are thinner than the
// lattice.
#pragma once

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// Chooses among the triangles that have equal corners one for each line and each point that nothing else has
// as a side or a corner: what passes through a voxel leaves it a trace, however thin it is, and a sliver
// between others needs none. `dropped`: one a triangle; takes the chosen ones out of it.
void keepLoneLines(const Topology& mesh, std::vector<bool>& dropped);

}  // namespace kelp::bake

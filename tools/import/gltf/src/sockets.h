// SPDX-License-Identifier: MIT
// Sockets drawn with empties: socket.NAME below the mesh.
#pragma once

#include <set>

#include "gltf_model.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// A node named socket.NAME, without a mesh, and the node of the part that it belongs to: the nearest one
// above it among `part_nodes`; -1: the part of everything else.
struct SocketNode {
  int node = -1;
  int owner = -1;
  std::string name;
};
std::vector<SocketNode> findSockets(const GltfModel& model, const std::set<int>& part_nodes);

// Gives the part, whose rig and place are complete, the sockets whose owner is `node`. Names that the rig has
// already stay as they are.
void addSockets(const GltfModel& model, const std::vector<SocketNode>& sockets, int node, SourcePart& part);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Sockets drawn with empties socket.NAME.
#pragma once

#include "gltf_model.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Whether the node is an empty of such a name.
bool isSocket(const GltfModel& model, int node);
// Gives the part these sockets. `space` takes its node's space to the world. Call it when the part has its
// rig: sockets that the rig has itself count instead, with a notice.
void addSockets(const GltfModel& model, const std::vector<int>& nodes, const glm::dmat4& space,
                SourcePart& part);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Sockets drawn with empties socket.NAME.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gltf_model.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Whether the node is an empty of such a name.
bool isSocket(const GltfModel& model, int node);
// The names of these sockets, each once; notices for those that have another's, and for too many.
std::vector<std::pair<int, std::string>> socketNames(const GltfModel& model, const std::vector<int>& nodes,
                                                     const std::string& part);
// Gives the part these sockets. `space` takes its node's space to the world. Call it when the part has its
// rig: sockets that the rig has itself count instead, with a notice.
void addSockets(const GltfModel& model, const std::vector<int>& nodes, const glm::dmat4& space,
                SourcePart& part);

}  // namespace kelp::bake

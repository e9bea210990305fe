// SPDX-License-Identifier: MIT
// Sockets of a skin on the parts of their joints.
#pragma once

#include <string>
#include <vector>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/skin/skin.h"

namespace kelp::bake {

// Gives the joints their sockets, and their boxes, which are the frame's, the length along y that these take
// (SkinJoint::grow). A socket beyond the longest box is left out, with a notice.
void addJointSockets(const SourceSkin& skin, const Frame& frame, std::vector<SkinJoint>& joints,
                     std::vector<std::string>& notices);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
#pragma once
#include "kelp/skin/skin.h"
namespace kelp::bake {
inline void addJointSockets(const SourceSkin&, const Frame&, std::vector<SkinJoint>&, std::vector<std::string>&) {}
}  // namespace kelp::bake

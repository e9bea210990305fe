// SPDX-License-Identifier: MIT
// From the sampled motions of joints to as few keys as keep them.
#pragma once

#include <span>
#include <vector>

#include "joints.h"

namespace kelp::bake {

// The clip of each joint, whose pivots (pivot space -> the soup's) are given. As jointsOfSkin() says.
std::vector<RigDescription::Clip> makeSkinKeys(const SourceSkin& skin, std::size_t clip,
                                               std::span<const glm::dmat4x3> pivots,
                                               std::span<const SkinNode> nodes, double tolerance,
                                               int threads);

}  // namespace kelp::bake

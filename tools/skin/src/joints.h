// SPDX-License-Identifier: MIT
// The joints of a skin as empty parts that move as they do.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"
#include "kelp/skin/skin.h"

namespace kelp::bake {

// A point that follows joints; soup space, at rest.
struct SkinNode {
  glm::dvec3 at{0};
  std::array<std::uint32_t, 4> joints{};
  std::array<double, 4> weights{};  // 0: none
};

// All joints, with their clips: at each time that a clip was sampled at, its keys take every node to within
// `tolerance` (soup units) of where the joints' own matrices do. Those that need more than translations,
// rotations and scales, which have shear, are replaced by the nearest that do not. Joints that move no node
// are within eight times as much. The same result with any number of threads.
std::vector<SkinJoint> jointsOfSkin(const SourceSkin& skin, std::span<const SkinNode> nodes, double tolerance,
                                    int threads);

// The motions of all joints by their keys, posed <- at rest, in the soup's space, as the runtime has them.
std::vector<glm::dmat4x3> keyedMotions(std::span<const SkinJoint> joints, std::size_t clip, double time);

}  // namespace kelp::bake

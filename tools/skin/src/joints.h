// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <span>

#include "kelp/skin/skin.h"

namespace kelp::bake {
struct SkinNode {
  glm::dvec3 at{0};
  std::array<std::uint32_t, 4> joints{};
  std::array<double, 4> weights{};
};
std::vector<SkinJoint> jointsOfSkin(const SourceSkin& skin, std::span<const SkinNode> nodes, double tolerance,
                                    int threads);
void limitJoints(SourceSkin& skin, std::size_t most, std::vector<std::string>& notices);
}  // namespace kelp::bake

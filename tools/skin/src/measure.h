// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "decompose.h"
#include "kelp/skin/skin.h"
#include "tree.h"

namespace kelp::bake {

struct ClipFit {
  SkinFit all;
  std::vector<SkinDistances> parts;
};

// Where samples of swept parts are in their straight parts; of others: anything.
std::vector<glm::vec3> straightPlaces(const SkinSamples& samples, const SkinLabels& labels,
                                      const PartTree& tree);

// How far a clip's keys put the samples from where linear blend skinning draws them. `straight`: their
// straightPlaces().
ClipFit measureClip(const SkinSamples& samples, const SourceSkin& skin, std::uint32_t clip,
                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree,
                    const std::vector<glm::vec3>& straight, const std::vector<RigDescription::Clip>& keys);

}  // namespace kelp::bake

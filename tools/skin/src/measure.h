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

// How far a clip's keys put the samples from where linear blend skinning draws them.
ClipFit measureClip(const SkinSamples& samples, const SourceSkin& skin, std::uint32_t clip,
                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree,
                    const std::vector<RigDescription::Clip>& keys);

}  // namespace kelp::bake

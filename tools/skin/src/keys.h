// SPDX-License-Identifier: MIT
// From motions of parts to as few keys as keep them.
#pragma once

#include <vector>

#include "decompose.h"
#include "tree.h"

namespace kelp::bake {

// The clip's motion of every part in the rig language: rotations about the pivot and translations, linear
// between keys, in the soup's axes and units; of swept parts the knots too. No sample of a rigid part, and no
// knot of a swept one, is farther than `tolerance` units from where the fit puts it, at every time that the
// clip was sampled.
std::vector<RigDescription::Clip> makeSkinKeys(const SkinSamples& samples, const SourceSkin& skin,
                                               std::uint32_t clip, const SkinSpace& space,
                                               const SkinLabels& labels, const PartTree& tree,
                                               double tolerance);

// Where such clips put the parts at a time.
std::vector<SkinPose> posesOfKeys(const std::vector<RigDescription::Clip>& clips, const PartTree& tree,
                                  const SkinSpace& space, double time);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Chains of joints, and which of them become one swept part.
#pragma once

#include <cstdint>
#include <vector>

#include "decompose.h"
#include "plan.h"

namespace kelp::bake {

// Joints one below the other, at least two, that bend one tube: each has one child with a surface, shares
// some of it with that child, and does not turn sharply. No joint is in two.
std::vector<std::vector<std::uint32_t>> findChains(const SkinSamples& samples, const SourceSkin& skin,
                                                   const SkinSpace& space);

// Makes one part of the parts along a chain where a swept part follows the surface better than they do; their
// seams count too. Chains that begin with a joint in `stiff` stay as they are.
void sweepChains(const SkinSamples& samples, const SourceSkin& skin, const SkinMoments& moments,
                 const SkinSpace& space, int threads, const StiffChains& stiff, SkinLabels& labels);

// The parts inside become one, which is swept.
void joinParts(const std::vector<bool>& inside, const SkinChain& chain, SkinLabels& labels);

}  // namespace kelp::bake

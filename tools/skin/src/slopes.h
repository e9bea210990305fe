// SPDX-License-Identifier: MIT
// How weights should go on below the surface.
#pragma once

#include <span>
#include <vector>

#include "fit.h"
#include "samples.h"

namespace kelp::bake {

// By how much each weight of each sample, in their order, should grow in a voxel along the normal. Zero where
// the motions of the sample's joints, blended by its weights, keep what is under the surface under it at all
// moments. Where the surface is turned over against them, and slopes of at most 0.1 put that right: these.
std::vector<double> slopesUnder(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
                                const SkinSamples& samples, std::span<const std::vector<SkinMoment>> moments,
                                int threads);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// The keys of a swept part's knots.
#pragma once

#include <vector>

#include "kelp/import/core/source_model.h"
#include "sweep.h"

namespace kelp::bake {

// The values of a linear track at a time: the keys around it.
struct Between {
  glm::vec4 a{0}, b{0};
  double share = 0;
};
Between valuesAt(const RigDescription::Track& track, double time);

// Whether the track moves a knot, not the part.
bool movesKnots(const RigDescription::Track& track);

// Adds tracks that keep each knot, and the section there, within `tolerance` voxels of the poses at the
// times.
void addKnotTracks(const SkinSweep& sweep, const std::vector<SkinPose>& poses,
                   const std::vector<float>& times, double tolerance, RigDescription::Clip& clip);

// The knots at a time of the clip.
std::vector<Knot> knotsAt(const SkinSweep& sweep, const RigDescription::Clip& clip, double time);

}  // namespace kelp::bake

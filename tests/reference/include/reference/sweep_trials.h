// SPDX-License-Identifier: MIT
// Many awkward rays through swept parts: sweep.glsl, compiled as C++, judged by the ground truth.
#pragma once

#include "kelp/formats/sweep.h"
#include "reference/trials.h"

namespace kelp::reference {

struct SweepRig {
  std::string name;
  std::vector<Knot> knots;
  float roll = 0;
};
// Straight, 30, 60 and 90 degrees, an S in three dimensions, a curl of 270 degrees, a helix, and one so tight
// that k u_max is 0.95. The curl and the tight one need a volume at least three times as high as wide.
std::vector<SweepRig> namedSweeps(const glm::ivec3& size);
// Two to five knots that can be swept, with k u_max up to kMostCurved.
SweepRig randomSweep(const glm::ivec3& size, unsigned seed);

// Rays of every kind: any direction; along the centre line; in a section's plane; across the plane of an arc;
// through an axis of curvature; close to a joint; along an axis; from inside; close past solid voxels; along
// a face of voxels; from 30 sizes of the bounds away.
inline constexpr int kSweepRayKinds = 11;
struct SweepTally : TrialTally {
  std::uint64_t clips = 0, arcs = 0;  // slices clipped, and slices there were
};
SweepTally runSweepTrial(const TrialVolume& volume, const SweepRig& rig, int rays, unsigned seed);

}  // namespace kelp::reference

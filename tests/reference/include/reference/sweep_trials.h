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
// Straight, 30, 45, 60 and 90 degrees, an S in three dimensions, a curl of 270 degrees, a helix, and one so
// tight that k u_max is 0.95. As long as the volume is high, or as long as it takes to bend that far.
std::vector<SweepRig> namedSweeps(const glm::ivec3& size);
// Two to five knots that can be swept, with k u_max up to kMostCurved.
SweepRig randomSweep(const glm::ivec3& size, unsigned seed);

// The arcs and joints of a chain as the tracing core has them, compiled here or there.
template <class TracedArc>
std::vector<TracedArc> arcsAs(const ArcChain& chain) {
  std::vector<TracedArc> arcs;
  for (const Arc& a : std::span(chain.arcs, static_cast<std::size_t>(chain.count)))
    arcs.push_back({a.middle, a.radius, a.along, a.curvature, a.inward, a.y, a.bend, a.rise});
  return arcs;
}
template <class TracedJoint>
std::vector<TracedJoint> jointsAs(const ArcChain& chain) {
  std::vector<TracedJoint> joints;
  for (const ArcJoint& j : std::span(chain.joints, static_cast<std::size_t>(chain.count) + 1))
    joints.push_back({j.plane, j.curvature, j.rise, j.y});
  return joints;
}

// Rays of every kind: any direction; along the center line; in a section's plane; across the plane of an arc;
// through an axis of curvature; close to a joint; along an axis; from inside; close past solid voxels; along
// a face of voxels; from 30 sizes of the bounds away.
inline constexpr int kSweepRayKinds = 11;
struct SweepTally : TrialTally {
  std::uint64_t clips = 0, arcs = 0;  // slices clipped, and slices there were

  void add(const SweepTally& more);
};
SweepTally runSweepTrial(const TrialVolume& volume, const SweepRig& rig, int rays, unsigned seed);

}  // namespace kelp::reference

// SPDX-License-Identifier: MIT
// Which sampled times of a motion get a key.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/rig/rig.h"
#include "rigid.h"

namespace kelp::bake {

// The motion of a joint within its pivot at all times of a clip, and what an error of it moves how far.
struct KeyedMotion {
  std::vector<Trs> poses;          // neighbors have quaternions of one sign
  std::vector<glm::dmat3> spread;  // pivot space -> the model's, as the joints above have it then
  std::size_t points = 0;
  // Of time t and point i at [t * points + i]: what the joint moves, in pivot space, before it does.
  std::vector<glm::dvec3> places;

  double reach() const;  // the farthest place from the pivot, as it is spread then
  double size() const;   // the most that `spread` makes of a unit
};

// The tracks of a joint: as few keys as keep each of the points within `tolerance` at all times. Tracks that
// change nothing are left out.
std::vector<RigDescription::Track> chooseTracks(const KeyedMotion& motion, const std::vector<float>& times,
                                                double tolerance);

// The track of a weight as a translation along x, likewise: none if it stays 0.
std::vector<RigDescription::Track> chooseWeightTrack(const std::vector<float>& weights,
                                                     const std::vector<float>& times, double tolerance);

// The motion of these tracks at a time, as the runtime has it.
Trs motionOfTracks(const std::vector<RigDescription::Track>& tracks, double time);

}  // namespace kelp::bake

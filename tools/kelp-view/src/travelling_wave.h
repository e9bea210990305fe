// SPDX-License-Identifier: MIT
// A wave that runs along the spline, for fish and ribbons: a(at) sin(2 pi (t / period - turns at)), and its
// slope by `at`.
#pragma once

#include "kelp/rig/rig.h"

namespace kelp::view {

struct TravellingWave {
  glm::vec3 first{0}, last{0};  // amplitudes at the two ends; 1 = the extent along the axis
  float period = 2;             // seconds
  float turns = 1;              // waves between the ends; negative: it runs from the last knot to the first
};

// Two waves for each knot, one for its place and one for its tangent; none where the amplitude is 0.
std::vector<RigDescription::Wave> wavesOf(const TravellingWave& wave,
                                          const std::vector<RigDescription::Knot>& knots);

}  // namespace kelp::view

// SPDX-License-Identifier: MIT
// A wave that runs along the spline, as a fish swims and ribbons flutter: a(at) sin(2 pi (t / period - turns at)), and its slope by `at`.
#pragma once

#include "kelp/rig_json/rig_json.h"

namespace viewer {

struct TravellingWave {
  glm::vec3 first{0}, last{0};  // amplitudes at the two ends; 1 = the extent along the axis
  float period = 2;             // seconds
  float turns = 1;              // waves between the ends; negative: it runs from the last knot to the first
};

// Two waves a knot, one of its place and one of its tangent; none where the amplitude is 0.
std::vector<kelp::RigDescription::Wave> wavesOf(const TravellingWave& wave, const std::vector<kelp::RigDescription::Knot>& knots);

}  // namespace viewer

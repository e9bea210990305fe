// SPDX-License-Identifier: MIT
// Waves of a rig that are more than one: of several phases, or along all knots.
#pragma once

#include <vector>

#include "kelp/rig/rig.h"

namespace kelp::view {

// The sum of waves of one period: sine * sin(2 pi t / period) + cosine * cos(2 pi t / period), for each axis.
struct Sinusoid {
  glm::vec3 sine{0}, cosine{0};

  void add(const glm::vec3& amplitude, float phase);  // amplitude * sin(2 pi (t / period + phase))
  // As waves of a rig: one for each phase that an axis has.
  void appendTo(std::vector<RigDescription::Wave>& waves, int knot, Target target, float period) const;
};

// A wave that runs along the spline, for fish and ribbons: a(at) sin(2 pi (t / period - turns at)), and its
// slope by `at`.
struct TravellingWave {
  glm::vec3 first{0}, last{0};  // amplitudes at the two ends; 1 = the extent along the axis
  float period = 2;             // seconds
  float turns = 1;              // waves between the ends; negative: it runs from the last knot to the first
};

// Two waves for each knot, one for its place and one for its tangent; none where the amplitude is 0.
std::vector<RigDescription::Wave> wavesOf(const TravellingWave& wave,
                                          const std::vector<RigDescription::Knot>& knots);

}  // namespace kelp::view

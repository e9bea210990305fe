// SPDX-License-Identifier: MIT
// The sum of waves of one period: sine * sin(2 pi t / period) + cosine * cos(2 pi t / period), for each axis.
#pragma once

#include "kelp/rig/rig.h"

namespace kelp::view {

struct Sinusoid {
  glm::vec3 sine{0}, cosine{0};

  void add(const glm::vec3& amplitude, float phase);  // amplitude * sin(2 pi (t / period + phase))
  // As waves of a rig: one for each phase that an axis has.
  void appendTo(std::vector<RigDescription::Wave>& waves, int knot, Target target, float period) const;
};

}  // namespace kelp::view

// SPDX-License-Identifier: MIT
// sine * sin(2 pi t / period) + cosine * cos(2 pi t / period), a number for each axis: how waves of one period add up.
#pragma once

#include "kelp/rig_json/rig_json.h"

namespace viewer {

struct Sinusoid {
  glm::vec3 sine{0}, cosine{0};

  void add(const glm::vec3& amplitude, float phase);  // amplitude * sin(2 pi (t / period + phase))
  // As waves of a rig: one for each phase that an axis has.
  void appendTo(std::vector<kelp::RigDescription::Wave>& waves, int knot, kelp::Target target, float period) const;
};

}  // namespace viewer

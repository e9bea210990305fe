// SPDX-License-Identifier: MIT
#include "travelling_wave.h"

#include "sinusoid.h"

namespace kelp::view {

std::vector<RigDescription::Wave> wavesOf(const TravellingWave& wave,
                                          const std::vector<RigDescription::Knot>& knots) {
  constexpr float kTau = 6.28318531f;
  std::vector<RigDescription::Wave> waves;
  for (int knot = 0; knot < static_cast<int>(knots.size()); ++knot) {
    const float at = knots[static_cast<std::size_t>(knot)].at;
    const glm::vec3 amplitude = glm::mix(wave.first, wave.last, at);
    const float phase = -wave.turns * at;
    Sinusoid place, slope;
    place.add(amplitude, phase);
    // d/d(at) of a sin(p - 2 pi turns at) is a' sin(...) - 2 pi turns a cos(...)
    slope.add(wave.last - wave.first, phase);
    slope.add(-kTau * wave.turns * amplitude, phase + 0.25f);
    place.appendTo(waves, knot, Target::kKnotOffset, wave.period);
    slope.appendTo(waves, knot, Target::kKnotTangent, wave.period);
  }
  return waves;
}

}  // namespace kelp::view

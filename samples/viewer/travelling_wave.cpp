// SPDX-License-Identifier: MIT
#include "travelling_wave.h"

#include <cmath>

namespace viewer {
namespace {

constexpr float kTau = 6.28318531f;

using Wave = kelp::RigDescription::Wave;

// Waves of one direction each: a sum of two directions with different phases is no single wave.
void add(std::vector<Wave>& waves, int knot, kelp::Target target, const glm::vec3& sine, const glm::vec3& cosine, float period, float phase) {
  std::vector<Wave> made;
  for (int axis = 0; axis < 3; ++axis) {
    const float size = std::hypot(sine[axis], cosine[axis]);
    if (size == 0) continue;
    glm::vec3 amplitude(0);
    amplitude[axis] = size;
    const float lag = phase + std::atan2(cosine[axis], sine[axis]) / kTau;
    const float turned = lag - std::round(lag);
    if (!made.empty() && std::abs(made.back().phase - turned) < 1e-5f) {
      made.back().amplitude += amplitude;
    } else {
      made.push_back({knot, target, amplitude, period, turned});
    }
  }
  waves.insert(waves.end(), made.begin(), made.end());
}

}  // namespace

std::vector<Wave> wavesOf(const TravellingWave& wave, const std::vector<kelp::RigDescription::Knot>& knots) {
  std::vector<Wave> waves;
  for (int knot = 0; knot < static_cast<int>(knots.size()); ++knot) {
    const float at = knots[static_cast<std::size_t>(knot)].at;
    const glm::vec3 amplitude = glm::mix(wave.first, wave.last, at);
    const float phase = -wave.turns * at;
    add(waves, knot, kelp::Target::kKnotOffset, amplitude, glm::vec3(0), wave.period, phase);
    // d/d(at) of a sin(p - turns at): a' sin(...) - 2 pi turns a cos(...)
    add(waves, knot, kelp::Target::kKnotTangent, wave.last - wave.first, -kTau * wave.turns * amplitude, wave.period, phase);
  }
  return waves;
}

}  // namespace viewer

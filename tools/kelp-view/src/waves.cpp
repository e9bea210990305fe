// SPDX-License-Identifier: MIT
#include "waves.h"

#include <cmath>

namespace kelp::view {
namespace {

constexpr float kTau = 6.28318531f;

float shortened(float value) { return std::round(value * 1e5f) / 1e5f + 0.0f; }

}  // namespace

void Sinusoid::add(const glm::vec3& amplitude, float phase) {
  sine += amplitude * std::cos(kTau * phase);
  cosine += amplitude * std::sin(kTau * phase);
}

void Sinusoid::appendTo(std::vector<RigDescription::Wave>& waves, int knot, Target target,
                        float period) const {
  const std::size_t first = waves.size();
  for (int axis = 0; axis < 3; ++axis) {
    float size = shortened(std::hypot(sine[axis], cosine[axis]));
    if (size == 0) continue;
    float phase = shortened(std::atan2(cosine[axis], sine[axis]) / kTau);
    if (std::abs(phase) > 0.25f) {  // the nearer half turn, backwards
      phase = shortened(phase - std::copysign(0.5f, phase));
      size = -size;
    }
    glm::vec3 amplitude(0);
    amplitude[axis] = size;
    if (waves.size() > first && std::abs(waves.back().phase - phase) < 2e-5f)
      waves.back().amplitude += amplitude;
    else
      waves.push_back({knot, target, amplitude, period, phase});
  }
}

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

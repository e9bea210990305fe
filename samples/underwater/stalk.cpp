// SPDX-License-Identifier: MIT
#include "stalk.h"

#include <cmath>

namespace underwater {
namespace {

constexpr float kFrequency = 4.0f;  // radians a second, undamped
constexpr float kDamping = 0.35f;   // 1: comes to rest without overshooting

}  // namespace

// x(a) = lean a^2 at the fraction a of the length; y' = sqrt(1 - |x'|^2) keeps dS/da at the length, and y is its integral.
void leanStalk(const glm::vec2& lean, float height, std::span<kelp::Knot> knots) {
  const float w = 2 * glm::length(lean);
  for (kelp::Knot& knot : knots) {
    const float a = knot.at, rise = std::sqrt(1 - w * w * a * a);
    const float y = w > 1e-3f ? 0.5f * (a * rise + std::asin(w * a) / w) : a;
    knot.position += height * glm::vec3(lean.x * a * a, y - a, lean.y * a * a);
    knot.tangent += height * glm::vec3(2 * lean.x * a, rise - 1, 2 * lean.y * a);
  }
}

glm::vec2 pushOf(const Visitor& visitor, const glm::vec3& foot, float height) {
  const glm::vec2 away(foot.x - visitor.at.x, foot.z - visitor.at.z);
  const float distance = glm::length(away), above = visitor.at.y - foot.y;
  if (distance >= visitor.reach || above > height + visitor.reach || above < -visitor.reach) return glm::vec2(0);
  const float near = 1 - distance / visitor.reach;
  const float low = glm::clamp(above / height, 0.25f, 1.0f);  // pushed near its foot, it hardly leans
  const glm::vec2 aside = distance > 1e-4f ? away / distance : glm::vec2(0);
  return near * near * (3 - 2 * near) * low * (0.42f * aside + 0.12f * glm::vec2(visitor.velocity.x, visitor.velocity.z));
}

glm::vec2 currentAt(const glm::vec2& at, double seconds) {
  const auto wave = [&](float x, float z, double period) {
    return static_cast<float>(std::sin(6.283185307 * (seconds / period - (x * at.x + z * at.y))));
  };
  const float surge = 0.07f + 0.10f * wave(0.045f, 0.02f, 7.0) + 0.035f * wave(-0.06f, 0.11f, 3.1);
  return {surge, 0.35f * surge + 0.04f * wave(0.09f, -0.05f, 4.3)};
}

glm::vec2 limitLean(const glm::vec2& lean) {
  const float ratio = glm::length(lean) / kMostLean;
  return lean / std::sqrt(1 + ratio * ratio);
}

void Sway::follow(const glm::vec2& wanted, float seconds) {
  // The exact motion of a damped oscillator towards a fixed aim: stable, whatever the frame takes.
  const float decay = kFrequency * kDamping, beat = kFrequency * std::sqrt(1 - kDamping * kDamping);
  const float shrink = std::exp(-decay * seconds), c = std::cos(beat * seconds), s = std::sin(beat * seconds) / beat;
  const glm::vec2 x = lean - wanted, v = speed;
  lean = wanted + shrink * (x * (c + decay * s) + v * s);
  speed = shrink * (v * (c - decay * s) - x * (kFrequency * kFrequency * s));
}

}  // namespace underwater

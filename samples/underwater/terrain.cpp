// SPDX-License-Identifier: MIT
#include "terrain.h"

namespace underwater {
namespace {

struct Swell {
  float x, z, amplitude, phase;  // radians a meter, meters, radians
};
constexpr Swell kDunes[] = {{0.31f, 0.13f, 0.16f, 0.4f},
                            {-0.17f, 0.42f, 0.13f, 2.1f},
                            {0.55f, -0.36f, 0.06f, 4.4f},
                            {0.83f, 0.71f, 0.03f, 1.2f}};

}  // namespace

float sandHeight(const glm::vec2& at) {
  float height = 0;
  for (const Swell& s : kDunes) height += s.amplitude * glm::sin(s.x * at.x + s.z * at.y + s.phase);
  return height;
}

glm::vec3 sandNormal(const glm::vec2& at) {
  glm::vec2 slope(0);
  for (const Swell& s : kDunes)
    slope += s.amplitude * glm::cos(s.x * at.x + s.z * at.y + s.phase) * glm::vec2(s.x, s.z);
  return glm::normalize(glm::vec3(-slope.x, 1, -slope.y));
}

float groveDensity(const glm::vec2& at) {
  const float patches = glm::sin(0.62f * at.x + 1.1f) * glm::sin(0.55f * at.y - 0.6f) +
                        0.5f * glm::sin(1.1f * at.x - 0.9f * at.y);
  const float outside = glm::smoothstep(1.2f * kGladeRadius, 1.6f * kGladeRadius, glm::length(at));
  return outside * glm::smoothstep(-1.0f, 0.6f, patches);
}

float bareSand(const glm::vec2& at) {
  const float patches = glm::sin(0.9f * at.x - 0.3f) + glm::sin(1.1f * at.y + 0.5f * at.x + 0.8f);
  return glm::smoothstep(-0.4f, 0.9f, patches) *
         (1 - glm::smoothstep(0.7f * kGladeRadius, 1.2f * kGladeRadius, glm::length(at)));
}

}  // namespace underwater

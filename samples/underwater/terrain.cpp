// SPDX-License-Identifier: MIT
#include "terrain.h"

#include <cmath>

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

glm::vec2 currentAt(const glm::vec2& at, double seconds) {
  const auto wave = [&](float x, float z, double period) {
    return static_cast<float>(std::sin(6.283185307 * (seconds / period - (x * at.x + z * at.y))));
  };
  const float surge = 0.07f + 0.10f * wave(0.045f, 0.02f, 7.0) + 0.035f * wave(-0.06f, 0.11f, 3.1);
  return {surge, 0.35f * surge + 0.04f * wave(0.09f, -0.05f, 4.3)};
}

FloorMesh makeFloorMesh(float radius, int rings, int spokes) {
  FloorMesh mesh;
  const auto add = [&mesh](const glm::vec2& at) {
    mesh.vertices.push_back({{at.x, sandHeight(at), at.y}, sandNormal(at)});
  };
  add(glm::vec2(0));
  for (int ring = 1; ring <= rings; ++ring) {
    const float share = static_cast<float>(ring) / static_cast<float>(rings),
                distance = radius * share * (0.4f + 0.6f * share);
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const float angle = 6.2831853f * static_cast<float>(spoke) / static_cast<float>(spokes);
      add(distance * glm::vec2(glm::cos(angle), glm::sin(angle)));
    }
  }
  const auto index = [spokes](int ring, int spoke) {
    return ring == 0 ? 0u : static_cast<std::uint32_t>(1 + (ring - 1) * spokes + spoke % spokes);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const std::uint32_t a = index(ring, spoke), b = index(ring, spoke + 1), c = index(ring + 1, spoke),
                          d = index(ring + 1, spoke + 1);
      mesh.indices.insert(mesh.indices.end(), {a, d, c});
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, b, d});
    }
  }
  return mesh;
}

}  // namespace underwater

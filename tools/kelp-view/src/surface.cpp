// SPDX-License-Identifier: MIT
#include "surface.h"

namespace kelp::view {

const char* toString(Surface surface) {
  constexpr const char* kNames[] = {"shaded", "normals", "levels", "steps", "distances"};
  return kNames[static_cast<int>(surface)];
}

std::optional<Surface> parseSurface(std::string_view name) {
  for (int i = 0; i < static_cast<int>(Surface::kCount); ++i) {
    if (name == toString(static_cast<Surface>(i))) return static_cast<Surface>(i);
  }
  return {};
}

const char* glslOf(Surface surface) {
  switch (surface) {
    case Surface::kNormals:
      return "vec4 kelpSurface(KelpSurface s) { return vec4(0.5 + 0.5 * s.normal, 1.0); }";
    case Surface::kLevels:
      return R"(vec4 kelpSurface(KelpSurface s) {
  vec3 hue = 0.5 + 0.5 * cos(6.2831853 * (float(s.level) * 0.236 + vec3(0.40, 0.07, 0.73)));
  return vec4(hue * (0.35 + 0.65 * max(dot(s.normal, s.view), 0.0)), 1.0);
})";
    case Surface::kSteps:
      return R"(vec4 kelpSurface(KelpSurface s) {
  float n = clamp(float(s.steps) / 48.0, 0.0, 1.0);
  vec3 few = mix(vec3(0.01, 0.03, 0.20), vec3(0.75, 0.12, 0.25), min(2.0 * n, 1.0));
  return vec4(mix(few, vec3(1.0, 0.9, 0.4), max(2.0 * n - 1.0, 0.0)), 1.0);
})";
    default:
      return nullptr;
  }
}

}  // namespace kelp::view

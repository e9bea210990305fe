// SPDX-License-Identifier: MIT
#include "views.h"

#include <fmt/format.h>

namespace kelp::render {
namespace {

constexpr char kNormals[] = "vec4 kelpSurface(KelpSurface s) { return vec4(0.5 + 0.5 * s.normal, 1.0); }\n";

// White at the near end of the model, black at the far end, linear in the distance from the camera's plane.
constexpr char kDepth[] = R"(
vec4 kelpSurface(KelpSurface s) {{
  const float near = {:.9e};
  const float far = {:.9e};
  float z = 2.0 * gl_FragDepth - 1.0;
  float distance = 2.0 * far * near / (far + near - z * (far - near));
  return vec4(vec3((far - distance) / (far - near)), 1.0);
}}
)";

// Blue 0, green 16, yellow 32, red 64 and more.
constexpr char kSteps[] = R"(
vec4 kelpSurface(KelpSurface s) {
  float x = clamp(float(s.steps) / 64.0, 0.0, 1.0);
  vec3 low = mix(vec3(0.1, 0.2, 0.7), vec3(0.1, 0.75, 0.3), clamp(4.0 * x, 0.0, 1.0));
  vec3 middle = mix(low, vec3(0.95, 0.85, 0.2), clamp(4.0 * x - 1.0, 0.0, 1.0));
  return vec4(mix(middle, vec3(0.85, 0.1, 0.1), clamp(2.0 * x - 1.0, 0.0, 1.0)), 1.0);
}
)";

// A color for each level, 0 gray, then around the circle; lit from the camera, so that the shape is seen.
constexpr char kLevel[] = R"(
vec4 kelpSurface(KelpSurface s) {
  vec3 around = 0.55 + 0.4 * cos(6.2831853 * (0.618034 * float(s.level) + vec3(0.0, 0.33, 0.67)));
  vec3 color = s.level == 0 ? vec3(0.8) : around;
  return vec4(color * (0.45 + 0.55 * max(dot(s.normal, s.view), 0.0)), 1.0);
}
)";

}  // namespace

ViewStyle styleOf(ViewKind kind, const Camera& camera) {
  ViewStyle style;
  switch (kind) {
    case ViewKind::kShaded:
      style.colors = true;
      style.background = {false, {0.93f, 0.93f, 0.92f}, {0.72f, 0.77f, 0.82f}};
      break;
    case ViewKind::kNormals:
      style.surface = kNormals;
      break;
    case ViewKind::kDepth:
      style.surface = fmt::format(kDepth, camera.nearPlane(), camera.farPlane());
      break;
    case ViewKind::kSteps:
      style.surface = kSteps;
      break;
    case ViewKind::kLevel:
      style.surface = kLevel;
      break;
    case ViewKind::kDistance:
      break;  // not of surfaces: kDistanceSlice
  }
  return style;
}

}  // namespace kelp::render

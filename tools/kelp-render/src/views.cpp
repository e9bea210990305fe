// SPDX-License-Identifier: MIT
#include "views.h"

#include <fmt/format.h>

#include "kelp/shaders/shaders.h"

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

// kelp draws these itself; for the paper's method, the same GLSL.
void explain(ViewStyle& style, gl::DebugView debug) {
  style.colors = true;
  style.debug = debug;
  style.surface = fmt::format("const int kelp_debug = {};\n{}", static_cast<int>(debug), shaders::kDebug);
}

}  // namespace

ViewStyle styleOf(ViewKind kind, const Camera& camera) {
  ViewStyle style;
  switch (kind) {
    case ViewKind::kShaded:
    case ViewKind::kBounds:
    case ViewKind::kSplines:
    case ViewKind::kCages:
      if (kind == ViewKind::kBounds) style.debug = gl::DebugView::kBounds;
      if (kind == ViewKind::kSplines) style.debug = gl::DebugView::kSplines;
      if (kind == ViewKind::kCages) style.debug = gl::DebugView::kCages;
      style.colors = true;
      style.background = {false, {0.93f, 0.93f, 0.92f}, {0.72f, 0.77f, 0.82f}};
      break;
    case ViewKind::kNormals:
      style.surface = kNormals;
      break;
    case ViewKind::kDepth:
      style.surface = fmt::format(kDepth, camera.nearPlane(), camera.farPlane());
      break;
    case ViewKind::kParts:
      explain(style, gl::DebugView::kParts);
      break;
    case ViewKind::kSteps:
      explain(style, gl::DebugView::kSteps);
      break;
    case ViewKind::kLevel:
      explain(style, gl::DebugView::kLevels);
      break;
    case ViewKind::kDistance:
      break;  // not of surfaces: kDistanceSlice
  }
  return style;
}

}  // namespace kelp::render

// SPDX-License-Identifier: MIT
// A fragment shader that shows distances on a slice through the middle of the view's depth, facing the
// camera, and its uniforms. Comes after the text of kelp::gl::Renderer::traceGlsl(), which needs
// gl::RendererOptions::distances.
#pragma once

#include <glm/glm.hpp>

namespace kelp {

inline constexpr char kDistanceSlice[] = R"(
layout(location = 0) out vec4 color;

uniform mat4 slice_clip_to_world;
uniform vec2 slice_viewport;  // pixels
uniform float slice_at;       // of the way from the near to the far plane along a ray
uniform float slice_contour;  // world units from one contour to the next

void main() {
  vec2 at = 2.0 * gl_FragCoord.xy / slice_viewport - 1.0;
  vec4 near = slice_clip_to_world * vec4(at, -1.0, 1.0);
  vec4 far = slice_clip_to_world * vec4(at, 1.0, 1.0);
  float d = kelpDistance(mix(near.xyz / near.w, far.xyz / far.w, slice_at)) / slice_contour;
  float width = clamp(fwidth(d), 1e-6, 0.3);
  float line = 1.0 - 0.5 * (1.0 - smoothstep(0.5, 1.5, abs(fract(d + 0.5) - 0.5) / width));
  float surface = smoothstep(1.0, 2.0, abs(d) / width);
  vec3 outside = mix(vec3(0.95, 0.97, 1.0), vec3(0.2, 0.4, 0.75), 1.0 - exp(-0.12 * d));
  vec3 inside = mix(vec3(1.0, 0.85, 0.6), vec3(0.75, 0.25, 0.1), 1.0 - exp(0.4 * d));
  color = vec4((d < 0.0 ? inside : outside) * line * surface, 1.0);
}
)";

struct DistanceSlice {
  glm::mat4 clip_to_world;
  float at;       // of the way from the near to the far plane along a ray
  float contour;  // world units from one contour to the next: a 32nd of the picture's height there

  // For a perspective projection with a finite far plane; `distance` of the slice from the camera's plane.
  DistanceSlice(const glm::mat4& world_to_eye, const glm::mat4& eye_to_clip, float distance)
      : clip_to_world(glm::inverse(glm::dmat4(eye_to_clip) * glm::dmat4(world_to_eye))) {
    const float near = nearOf(eye_to_clip), far = farOf(eye_to_clip);
    at = (distance - near) / (far - near);
    contour = distance / eye_to_clip[1][1] / 16;
  }
  static float nearOf(const glm::mat4& eye_to_clip) { return eye_to_clip[3][2] / (eye_to_clip[2][2] - 1); }
  static float farOf(const glm::mat4& eye_to_clip) { return eye_to_clip[3][2] / (eye_to_clip[2][2] + 1); }
};

}  // namespace kelp

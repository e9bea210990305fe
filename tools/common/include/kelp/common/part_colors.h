// SPDX-License-Identifier: MIT
// The colours of parts, each by its own or by how closely it follows a skin, and how they get onto a picture:
// as GLSL for kelp::gl::RendererOptions::surface_glsl, and the texture that it reads.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace kelp {

// sRGB. It depends on the index alone. Those of the first two dozen parts are told apart easily.
glm::u8vec3 partColor(int part);

// Voxels. What kelp-bake warns of at its default resolution: farther off, joints look broken.
inline constexpr double kPoorFit = 4;
// sRGB: green at 0, yellow at half of kPoorFit, red from kPoorFit on; grey if it is not known.
glm::u8vec3 fitColor(std::optional<double> voxels);

// Reads the colours below, and darkens what is turned away from the eye. The host sets in View::bind:
// part_colors, a texture of PartTexels, and part_rows.
inline constexpr char kPartSurface[] = R"(
uniform sampler2D part_colors;
uniform int part_rows;
vec4 kelpSurface(KelpSurface s) {
  ivec2 at = ivec2(s.part % 1024, s.instance * part_rows + s.part / 1024);
  vec3 color = texelFetch(part_colors, at, 0).rgb;
  return vec4(color * (0.55 + 0.45 * max(dot(s.normal, s.view), 0.0)), 1.0);
}
)";

// Colours of the parts of several instances as one texture. An instance has `rows` rows of at most 1024
// texels.
struct PartTexels {
  glm::ivec2 size{0};
  int rows = 0;
  std::vector<glm::u8vec4> texels;

  explicit PartTexels(std::span<const std::vector<glm::u8vec3>> instances);
};

}  // namespace kelp

// SPDX-License-Identifier: MIT
#include "kelp/common/part_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>

#include "kelp/common/srgb.h"

namespace kelp {
namespace {

constexpr int kRowLength = 1024;  // as kPartSurface has it; every context has textures so wide

// B. Ottosson, "A perceptual color space for image processing", 2020: OKLab in polar coordinates.
glm::u8vec3 fromOklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const glm::dvec3 root(lightness + 0.3963377774 * a + 0.2158037573 * b,
                        lightness - 0.1055613458 * a - 0.0638541728 * b,
                        lightness - 0.0894841775 * a - 1.2914855480 * b);
  const glm::dvec3 cone = root * root * root;
  return {linearToSrgb8(4.0767416621 * cone.x - 3.3077115913 * cone.y + 0.2309699292 * cone.z),
          linearToSrgb8(-1.2684380046 * cone.x + 2.6097574011 * cone.y - 0.3413193965 * cone.z),
          linearToSrgb8(-0.0041960863 * cone.x - 0.7034186147 * cone.y + 1.7076147010 * cone.z)};
}

}  // namespace

// Light, medium and dark in turn, with hues far apart; hues of the same lightness by the golden ratio.
glm::u8vec3 partColor(int part) {
  constexpr double kLightness[] = {0.84, 0.68, 0.52};
  const double turns = 0.06 + std::numbers::phi * (part / 3) + 0.38 * (part % 3);
  return fromOklch(kLightness[part % 3], 0.16, 2 * std::numbers::pi * turns);
}

glm::u8vec3 fitColor(std::optional<double> voxels) {
  constexpr glm::dvec3 kScale[] = {{40, 165, 80}, {250, 220, 70}, {215, 45, 40}};
  if (!voxels) return {140, 140, 140};
  const double at = std::clamp(2 * *voxels / kPoorFit, 0.0, 2.0);
  const int from = at < 1 ? 0 : 1;
  return {glm::round(glm::mix(kScale[from], kScale[from + 1], at - from))};
}

PartTexels::PartTexels(std::span<const std::vector<glm::u8vec3>> instances) {
  std::size_t most = 1;
  for (const auto& colors : instances) most = std::max(most, colors.size());
  size.x = static_cast<int>(std::min<std::size_t>(most, kRowLength));
  rows = static_cast<int>((most + kRowLength - 1) / kRowLength);
  size.y = rows * std::max(static_cast<int>(instances.size()), 1);
  texels.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  // if there are several rows, they are full
  const std::size_t stride = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(rows);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    for (std::size_t part = 0; part < instances[i].size(); ++part)
      texels[i * stride + part] = glm::u8vec4(instances[i][part], 255);
  }
}

}  // namespace kelp

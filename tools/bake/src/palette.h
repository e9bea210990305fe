// SPDX-License-Identifier: MIT
// The space in which materials are compared.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <glm/vec3.hpp>

#include "kelp/bake/bake.h"

namespace kelp::bake {

// Linear Rec. 709 to OKLab (L, a, b), where distances are about as large as they look. Source: Ottosson, "A
// perceptual color space for image processing", 2020.
inline glm::vec3 toOklab(const glm::vec3& c) {
  const float l = std::cbrt(0.4122214708f * c.x + 0.5363325363f * c.y + 0.0514459929f * c.z);
  const float m = std::cbrt(0.2119034982f * c.x + 0.6806995451f * c.y + 0.1073969566f * c.z);
  const float s = std::cbrt(0.0883024619f * c.x + 0.2817188376f * c.y + 0.6299787005f * c.z);
  return {0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s,
          1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
          0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s};
}

// A material as a point: base color in OKLab, alpha, emissive in OKLab, metallic, roughness; weighted so
// that equal distances matter about equally. The color decides; gloss weighs less, for it shows only where
// light is reflected.
using MaterialPoint = std::array<float, 9>;

inline MaterialPoint materialPoint(const Material& m) {
  const glm::vec3 base = toOklab(glm::vec3(m.base_color));
  const glm::vec3 glow = toOklab(m.emissive);
  return {base.x,
          base.y,
          base.z,
          0.5f * m.base_color.w,
          glow.x,
          glow.y,
          glow.z,
          0.25f * m.metallic,
          0.25f * m.roughness};
}

inline float squaredDistance(const MaterialPoint& a, const MaterialPoint& b) {
  float sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// The best palette of at most `limit` entries (chosen in OKLab, exact where that many are enough), the
// samples' indices and the mean error.
Palette clusterPalette(const std::vector<const VoxelGrid*>& grids, std::size_t limit, int threads);
// The number of distinct materials of the samples; `limit` + 1 if there are more than `limit`.
std::size_t countDistinct(const std::vector<const VoxelGrid*>& grids, std::size_t limit);

// Distance of two colors in OKLab.
double colorDistance(const Material& a, const Material& b);

// Index of the entry nearest to `point`; the lowest of several.
std::size_t nearestEntry(const std::vector<MaterialPoint>& entries, const MaterialPoint& point);

}  // namespace kelp::bake

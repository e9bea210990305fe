// SPDX-License-Identifier: MIT
// The space in which materials are compared.
#pragma once

#include <array>
#include <cstddef>

#include "kelp/bake/bake.h"
#include "oklab.h"

namespace kelp::bake {

// A material as a point: base colour in OKLab, alpha, emissive in OKLab, metallic, roughness; weighted so
// that equal distances matter about equally. The colour decides; gloss weighs less, for it shows only where
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

// Distance of two colours in OKLab.
double colorDistance(const Material& a, const Material& b);

// Index of the entry nearest to `point`; the lowest of several.
std::size_t nearestEntry(const std::vector<MaterialPoint>& entries, const MaterialPoint& point);

}  // namespace kelp::bake

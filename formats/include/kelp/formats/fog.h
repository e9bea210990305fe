// SPDX-License-Identifier: MIT
// How fog is stored: samples at the centers of voxels. Each has a density and, if the part has a ramp, a
// heat. formats/SPEC.md, section 6, defines this; the header is that section in C++.
//
// Between eight samples lies a *cube*, in which density and heat are trilinear. Between the outermost samples
// and the faces of the volume, the values are those of the nearest point between samples. A brick has 8 x 8 x
// 8 cubes and holds the 9 x 9 x 9 samples at their corners, so that it can be drawn alone. A cube is *clear*
// if density and heat are 0 at all its corners. Grid cells are those of solid parts (kelp/formats/brick.h),
// with "cube that is not clear" in place of "solid voxel".
#pragma once

#include <cmath>
#include <cstdint>

#include <glm/common.hpp>

#include "kelp/formats/brick.h"
#include "kelp/formats/model.h"

namespace kelp {

inline constexpr int kFogSide = kBrickSide + 1;
inline constexpr int kFogSamples = kFogSide * kFogSide * kFogSide;  // a brick; index x + 9 (y + 9 z)

// The size that a level's grid divides: voxels of a solid part, cubes of fog.
inline glm::ivec3 latticeSize(PartKind kind, const glm::ivec3& size) {
  return kind == PartKind::kFog ? glm::max(size - 1, glm::ivec3(1)) : size;
}

// density = (code / 255)^2: thin fog gets finer steps than dense fog. Heat is code / 255.
inline float fogDensity(std::uint8_t code) {
  return static_cast<float>(code) * static_cast<float>(code) / 65025.0f;
}
// The code nearest to a density, which is clamped to [0, 1]. NaN gives 0.
inline std::uint8_t fogCode(double density) {
  density = density > 0 ? (density < 1 ? density : 1.0) : 0.0;
  const int code = static_cast<int>(std::sqrt(density) * 255.0);
  // Rounds at the middle between two squares, not between two roots.
  return static_cast<std::uint8_t>(
      code < 255 && density * 65025.0 >= 0.5 * (code * code + (code + 1) * (code + 1)) ? code + 1 : code);
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
// How fog is stored: samples at the centres of voxels, a density and, if the part has any, a heat for each. formats/SPEC.md is the law; this header is
// its fog section in C++.
//
// Between eight samples lies a *cube*, in which density and heat are trilinear; outside the outermost samples, up to the volume's faces, they are as at
// the nearest point between them. Bricks are of 8 x 8 x 8 cubes and hold the 9 x 9 x 9 samples at their corners, so that a brick can be drawn alone.
// Grid cells are those of solid parts (kelp/formats/brick.h), with "cube that is not clear" for "solid voxel". A cube is clear if density and heat are
// 0 at all its corners.
#pragma once

#include <cmath>
#include <cstdint>

#include <glm/common.hpp>

#include "kelp/formats/brick.h"
#include "kelp/formats/model.h"

namespace kelp {

inline constexpr int kFogSide = kBrickSide + 1;
inline constexpr int kFogSamples = kFogSide * kFogSide * kFogSide;  // of a brick: x + 9 (y + 9 z)

// What a level of `size` voxels is divided into: voxels if it is solid, cubes if it is fog.
inline glm::ivec3 latticeSize(PartKind kind, const glm::ivec3& size) { return kind == PartKind::kFog ? glm::max(size - 1, glm::ivec3(1)) : size; }

// Codes are squares, so that thin fog has as many steps as dense: density = (code / 255)^2. Heat is code / 255.
inline float fogDensity(std::uint8_t code) { return static_cast<float>(code) * static_cast<float>(code) / 65025.0f; }
// The nearest code to a density, cut to 0 .. 1; 0 if it is not a number.
inline std::uint8_t fogCode(double density) {
  density = density > 0 ? (density < 1 ? density : 1.0) : 0.0;
  const int code = static_cast<int>(std::sqrt(density) * 255.0);
  // The middle between two squares, not between two roots.
  return static_cast<std::uint8_t>(code < 255 && density * 65025.0 >= 0.5 * (code * code + (code + 1) * (code + 1)) ? code + 1 : code);
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
// How distances are stored: formats/SPEC.md, section 5.4, in C++. Bricks of 8 x 8 x 8 one-byte codes:
//
//   code
//     0          Empty, and no solid voxel within the band.
//     1 .. 225   Empty; the squared distance to the nearest solid voxel.
//     227 .. 254 Solid; 255 - code = the squared distance to the nearest empty voxel.
//     255        Solid, and no empty voxel within the band.
//
// Distances go from center to center of voxels, in voxels of the level; everything outside of a level is
// empty. They are exact. A level has a band of its own; levels go on, each half as fine, until the band of
// the last reaches all of its voxels.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "kelp/formats/brick.h"

namespace kelp {

// The largest squared distances that a level stores, of empty voxels and of solid ones.
struct DistanceBand {
  std::uint8_t outside = 36;
  std::uint8_t inside = 9;

  bool operator==(const DistanceBand&) const = default;
};
inline constexpr DistanceBand kNarrowestBand{16, 4}, kWidestBand{225, 28};

inline constexpr std::uint8_t kFarOutside = 0, kFarInside = 255;

inline bool isInside(std::uint8_t code) { return code > kWidestBand.outside; }
// The squared distance that a code states; 0: it is beyond the band.
inline int squaredOf(std::uint8_t code) { return isInside(code) ? 255 - code : code; }

// The signed distance of a voxel's center from the surface, halfway between it and the nearest voxel of the
// other kind, in voxels of the level: at least 0.5 outside, at most -0.5 inside, infinite beyond the band.
inline float signedDistanceOf(std::uint8_t code) {
  const int squared = squaredOf(code);
  const float distance =
      squared > 0 ? std::sqrt(static_cast<float>(squared)) - 0.5f : std::numeric_limits<float>::infinity();
  return isInside(code) ? -distance : distance;
}

// The gradient of the signed distance at a voxel: differences between the two neighbors along each axis, or
// between the voxel and the one neighbor that is within the band, normalized. 0 where the voxel is beyond
// the band, and where all differences are 0. beside: the neighbors at -x, +x, -y, +y, -z, +z.
inline glm::vec3 distanceGradient(std::uint8_t code, const std::uint8_t (&beside)[6]) {
  if (squaredOf(code) == 0) return glm::vec3(0);
  const float here = signedDistanceOf(code);
  glm::vec3 gradient(0);
  for (int axis = 0; axis < 3; ++axis) {
    const float low = signedDistanceOf(beside[2 * axis]), high = signedDistanceOf(beside[2 * axis + 1]);
    if (std::isfinite(low) && std::isfinite(high))
      gradient[axis] = 0.5f * (high - low);
    else if (std::isfinite(high))
      gradient[axis] = high - here;
    else if (std::isfinite(low))
      gradient[axis] = here - low;
  }
  const float length = glm::length(gradient);
  return length > 0 ? gradient / length : glm::vec3(0);
}

// Levels of distances of a solid part of `size` level-0 voxels: at least as many as its levels of voxels, and
// until the longest side has at most 8 voxels.
int distanceLevels(const glm::ivec3& size, int levels);
// The band that writers give a level; the last level gets the widest, which covers it.
DistanceBand distanceBand(const glm::ivec3& size, int levels, int level);

// The codes of a brick, computed from the bits of the bricks around it. around[(i + 2) + 5 ((j + 2) + 5 (k +
// 2))]: the brick (i, j, k) bricks beside it; null: nothing is known of that brick, so its voxels count as
// neither solid nor empty. Those two bricks away matter from squared distances of 81 on, and may be null
// where the band is below 81. The brick itself must not be null. codes: 512.
void computeDistanceCodes(std::span<const BrickBits* const, 125> around, DistanceBand band,
                          std::span<std::uint8_t, kBrickVoxels> codes);

}  // namespace kelp

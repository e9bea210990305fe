// SPDX-License-Identifier: MIT
// The stored distances around a point of the undeformed part.
#pragma once

#include <span>

#include <glm/glm.hpp>

#include "kelp/formats/brick.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/level.h"

namespace kelp::runtime {

// The code of a voxel of the level.
inline std::uint8_t distanceCode(const Level& level, const glm::ivec3& voxel) {
  const glm::ivec3 brick = voxel >> 3;
  const std::uint32_t cell =
      level.cells[static_cast<std::size_t>(brick.x) +
                  static_cast<std::size_t>(level.grid.x) *
                      (static_cast<std::size_t>(brick.y) +
                       static_cast<std::size_t>(level.grid.y) * static_cast<std::size_t>(brick.z))];
  if (!(cell & kCellSolid)) return static_cast<std::uint8_t>(cell);
  const std::size_t slot = level.first_slots[cellPage(cell)] + cellBrick(cell);
  return level.codes[slot * kBrickVoxels + static_cast<std::size_t>(codeIndex(voxel))];
}

// Lengths in level-0 voxels.
struct RestDistance {
  double bound = 0;       // no solid level-0 voxel is nearer
  double depth = 0;       // inside: no empty level-0 voxel, nor the outside of the part, is nearer
  bool inside = false;    // of a solid level-0 voxel
  int level = 0;          // that answered
  glm::vec3 gradient{0};  // of the signed distance; not of length 1
};

// point: inside of the part's box. nullopt: no level of the part's distances is in memory.
std::optional<RestDistance> restDistance(const Asset& asset, int part, const glm::dvec3& point);

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// The distances of one level of one part in memory, with access voxel by voxel.
#pragma once

#include <glm/vec3.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/formats/distance.h"
#include "kelp/formats/raw_pack.h"
#include "pack/pack_file.h"

namespace kelp::dump {

class LevelDistances {
 public:
  // Reads all of a level, which the pack must have. ToolError; kRuntime if it is larger than this machine's
  // memory.
  LevelDistances(PackFile& file, std::uint32_t part, int level);

  const glm::ivec3& size() const { return size_; }  // voxels
  const glm::ivec3& grid() const { return grid_; }  // bricks
  const RawDistances& raw() const { return raw_; }
  // The code of a voxel of the grid's bricks; outside of the level, beyond the band.
  std::uint8_t code(const glm::ivec3& voxel) const {
    for (int axis = 0; axis < 3; ++axis)
      if (voxel[axis] < 0 || voxel[axis] >= size_[axis]) return kFarOutside;
    const std::uint32_t cell = raw_.cells[denseIndex(grid_, voxel / kBrickSide)];
    return cell & kCellSolid ? raw_.codes[std::size_t{cell & kCellSlotMask} * kBrickVoxels +
                                          static_cast<std::size_t>(codeIndex(voxel))]
                             : static_cast<std::uint8_t>(cell);
  }
  glm::vec3 gradient(const glm::ivec3& voxel) const;

 private:
  glm::ivec3 size_{0}, grid_{0};
  RawDistances raw_;
};

}  // namespace kelp::dump

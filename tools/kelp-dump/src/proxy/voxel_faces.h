// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "pack/level_voxels.h"

namespace kelp::dump {

// A side of a voxel's cube. Corners of the cube, counter-clockwise seen from outside.
struct VoxelFace {
  glm::ivec3 outward{0};
  std::array<glm::ivec3, 4> corners;
};

// Sides: -x, +x, -y, +y, -z, +z.
inline VoxelFace voxelFace(int side) {
  const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool high = side % 2 == 1;
  VoxelFace face;
  face.outward[axis] = high ? 1 : -1;
  for (int i = 0; i < 4; ++i) {
    const int at = high ? i : 3 - i;  // (0,0) (1,0) (1,1) (0,1), or back
    glm::ivec3& corner = face.corners[static_cast<std::size_t>(i)];
    corner = glm::ivec3(0);
    corner[axis] = high ? 1 : 0;
    corner[u] = at == 1 || at == 2 ? 1 : 0;
    corner[v] = at >= 2 ? 1 : 0;
  }
  return face;
}

// Calls f(voxel, face) for every face between a solid voxel and an empty one.
template <class F>
void eachFace(const LevelVoxels& level, F&& f) {
  std::array<VoxelFace, 6> faces;
  for (int side = 0; side < 6; ++side) faces[static_cast<std::size_t>(side)] = voxelFace(side);
  level.eachSolid([&](const glm::ivec3& voxel) {
    for (const VoxelFace& face : faces)
      if (!level.solid(voxel + face.outward)) f(voxel, face);
  });
}

}  // namespace kelp::dump

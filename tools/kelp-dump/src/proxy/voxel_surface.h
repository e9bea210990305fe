// SPDX-License-Identifier: MIT
// The faces between solid and empty voxels as one closed triangle mesh that is manifold wherever voxels
// touch.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "pack/level_voxels.h"

namespace kelp::dump {

// One face of a solid voxel that borders on an empty one. Sides: -x, +x, -y, +y, -z, +z.
struct VoxelFace {
  glm::ivec3 voxel{0};
  int side = 0;

  int axis() const { return side / 2; }
  glm::ivec3 outward() const {
    glm::ivec3 normal(0);
    normal[axis()] = side % 2 ? 1 : -1;
    return normal;
  }
  // Corner 0 to 3, counter-clockwise seen from outside, in voxels.
  glm::ivec3 corner(int i) const;
  glm::dvec3 middle() const { return (glm::dvec3(corner(0)) + glm::dvec3(corner(2))) * 0.5; }
  // The direction from the face's middle to its edge from corner i to corner i + 1.
  glm::ivec3 sideways(int i) const;
};

std::vector<VoxelFace> facesOf(const LevelVoxels& level);

// Every edge belongs to two triangles that run along it in opposite directions, and the triangles at a
// vertex are one fan. Voxels that share just an edge are joined there by a lens: the edge has two copies,
// each with a vertex at its middle. Where voxels share just a corner, each has a vertex of its own.
struct VoxelSurface {
  std::vector<glm::dvec3> origin;  // of each vertex: on the faces, in voxels
  std::vector<glm::dvec3> place;   // smoothed
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> owner;  // of each face: its first triangle
};

// Vertices move at most `most` voxels from where they were, and less than half a voxel along an axis.
VoxelSurface surfaceOf(const LevelVoxels& level, const std::vector<VoxelFace>& faces, double most);

}  // namespace kelp::dump

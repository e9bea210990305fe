// SPDX-License-Identifier: MIT
// The voxels of a part in the index space of a grid.
#pragma once

#include "grid_file.h"
#include "kelp/import/core/import_settings.h"

namespace kelp::bake {

// Of what is to be kept. Voxel centers are at whole numbers.
struct IndexBox {
  glm::dvec3 low{INFINITY}, high{-INFINITY};  // where it ends, between voxels
  // its voxels, both inclusive
  glm::ivec3 first{std::numeric_limits<int>::max()}, last{std::numeric_limits<int>::min()};
};

struct Lattice {
  glm::ivec3 size{0};
  glm::dmat4 to_index{1};  // part voxels (corners at whole numbers) -> index space
  bool exact = false;      // voxel centers are the grid's own

  glm::dvec3 center(const glm::ivec3& voxel, const glm::dvec3& offset = glm::dvec3(0)) const {
    return glm::dvec3(to_index * glm::dvec4(glm::dvec3(voxel) + 0.5 + offset, 1));
  }
};

// The edge of a cube that has the volume of a grid's voxel.
double voxelEdge(const glm::dmat4& to_world);
// The shortest of the three edges of a grid's voxel.
double shortestEdge(const glm::dmat4& to_world);
// The edge of the cubes that a grid becomes: shortestEdge of raw volumes, voxelEdge of all others.
double cubeEdge(const VolumeGrid& grid, const glm::dmat4& to_world);
// True if a grid's voxels can be kept: the settings ask for no others, or it was made for them, and its
// transform is quarter turns, mirrors and one scale for all axes.
bool keepsVoxels(const VolumeGrid& grid, const glm::dmat4& index_to_rig, const ImportSettings& settings);
Lattice ownLattice(const IndexBox& box, const glm::dmat4& index_to_rig);
// Cubes as the settings ask; else as large as the grid's voxels, of raw volumes as their shortest edge.
Lattice newLattice(const InputFiles& files, const IndexBox& box, const VolumeGrid& grid,
                   const glm::dmat4& index_to_rig, const ImportSettings& settings);
// More than a pack's voxels along a side, by the grid's own voxels.
void checkSides(const InputFiles& files, const glm::dvec3& size);
// ToolError kInvalid for transforms that flatten the grid or are no numbers.
void checkTransform(const InputFiles& files, const GridHeader& grid);

}  // namespace kelp::bake

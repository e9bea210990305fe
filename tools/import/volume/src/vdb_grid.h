// SPDX-License-Identifier: MIT
// OpenVDB's grids as volumes.
#pragma once

#include <kelp/common/openvdb.h>

#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/input_files.h"
#include "volume_grid.h"

namespace kelp::bake {

// The tiles of a node, active or not. OpenVDB 10's const iterator of those of a root does not compile.
template <class Node>
auto tilesOf(const Node& node) {
  if constexpr (Node::LEVEL == 3)
    return node.cbeginValueAll();
  else
    return node.cbeginChildOff();
}

// The word within "Tree_float_5_4_3"; empty where the tree has other nodes.
std::string valueWord(const std::string& tree_type);
GridKind kindOf(const std::string& tree_type);
GridClass classOf(openvdb::GridClass grid_class);

// Counts the active voxels and finds their box. ToolError kInvalid for nodes in the wrong place.
void describeVoxels(const InputFiles& files, const std::string& place, const openvdb::GridBase& grid,
                    GridHeader& header);
// Of kinds that can be read.
VolumeGrid volumeOf(const openvdb::GridBase::ConstPtr& grid);

// ToolError if so many cubes would be too many.
void checkCubes(const InputFiles& files, const std::string& place, double longest, double edge,
                const ImportSettings& settings);

// Cubes of the voxels of a frustum grid: each has the number at its center, trilinear in the frustum's own
// lattice. They are as large as the settings ask, or have the volume of the voxel in the middle of the grid.
openvdb::GridBase::Ptr cubesOfFrustum(const InputFiles& files, const std::string& place,
                                      const openvdb::GridBase& grid, const ImportSettings& settings);

struct Spheres {
  openvdb::GridBase::Ptr surface, color;  // a level set; null without colors
  std::string notice;
};
// The union of the spheres about the points of a grid.
Spheres spheresOf(const InputFiles& files, const std::string& place, const openvdb::GridBase& points,
                  const ImportSettings& settings);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// The nodes of a cage for a soft body or another solver of the host's, which puts them where it
// likes by Pose::nodes(). Of the part's finest cage; nodes are numbered as there. Beside this,
// cages[0].rest(i) is where node i is at rest, in part space (level-0 voxels), and cages[0].node(cell,
// corner) the eight of a cell; part.to_object has the size of a voxel in meters. samples/jelly uses all of
// it.
//
// Any thread may call these at any time. They take time in proportion to the part's voxels: call them once,
// when the asset is loaded, and keep the answers. kMisuse: there is no such part. One without a cage has no
// nodes.
#pragma once

#include "kelp/runtime/asset.h"

namespace kelp::runtime {

// How much of the solid each node carries, in level-0 voxels: times the mass of a voxel, its mass. A voxel is
// shared among the corners of its tetrahedron as its center lies between them (their barycentric
// coordinates), so that the sum is the number of solid voxels, and the center of mass is that of the solid,
// wherever the nodes are. Nodes that no voxel is near carry little, or nothing. Cubes in the middle of the
// solid, which have no cell, are carried by the nodes around it: each third of their voxels by the faces at
// the two ends of their row along an axis. volumes: one for each node; kMisuse for any other number. kNotYet:
// level 0 of the part is not in memory (Asset::loadAll()).
Result<void> nodeVolumes(const Asset& asset, int part, std::span<float> volumes);

struct NodeEdge {
  std::uint32_t a = 0, b = 0;  // a < b

  auto operator<=>(const NodeEdge&) const = default;
};
// The pairs of neighboring nodes: the edges of all tetrahedra, that is the edges of the cells, a diagonal of
// each of their faces and one through each cell. Each once, ascending. Their length at rest follows from the
// nodes' places. Pieces that do not touch have none in common. `allocator` holds the answer. kOutOfMemory.
Result<Buffer<NodeEdge>> nodeEdges(const Asset& asset, int part, const Allocator& allocator = {});

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// Size and place of a part's voxels.
#pragma once

#include <string>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The frame a part is voxelized in: `size` voxels of edge voxel_size; voxel = node_to_voxel * node.
struct Frame {
  glm::ivec3 size{0};
  double voxel_size = 0;
  glm::dmat4 node_to_voxel{1};
};
// The rig frame of a soup: its bounding box, turned so that the rig's axis is +y. `what` names the part in
// errors; `meters` is the length of a unit of the soup, for errors too. ToolError kUsage for a voxel size
// that is not positive or makes too many voxels; kInvalid for a soup that is empty, not finite, or so far
// from its origin that voxels cannot be told apart.
Frame makeFrame(const TriangleSoup& soup, Axis axis, double voxel_size, const std::string& what,
                double meters = 1);

// The most level-0 voxels along a side: what the pack reader accepts by default.
inline constexpr int kMaxResolution = 8192;
// Bounds for the edge of a voxel, in units of the file, so that squares and volumes of lengths stay within a
// float's range.
inline constexpr double kSmallestVoxel = 1e-12, kLargestVoxel = 1e12;
// The farthest that a mesh may lie from its origin, in voxels. There doubles still resolve half a step of the
// filler's lattice.
inline constexpr double kFarthest = 0x1p38;

// Extents of the soup in the rig's axes (x, y, z with y along the spline); node units. ToolError kInvalid if
// the soup is empty or not finite.
glm::dvec3 rigExtent(const TriangleSoup& soup, Axis axis, const std::string& what);

// The smallest voxel size from `wanted` on that divides `extent_y` into whole voxels, so that the spline
// spans exactly the source. With fewer than eight voxels along y this could change the size by more than an
// eighth: then `wanted` is returned.
double fitVoxelSize(double extent_y, double wanted);

// ToolError kUsage if a side of the padded `size` is longer than a pack can have. `what` names the part.
void checkPadded(const glm::ivec3& size, int pad, const std::string& what);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// How large a part's voxels are.
#pragma once

#include "kelp/bake/bake.h"

namespace kelp::bake {

// Level-0 voxels a side may have: what the reader's default limits accept.
inline constexpr int kMaxResolution = 8192;
// Edges of a voxel, in units: squares and volumes of lengths stay within a float's range.
inline constexpr double kSmallestVoxel = 1e-12, kLargestVoxel = 1e12;
// Voxels that a mesh may lie from its origin: doubles tell half a lattice step apart there (fill_topology.h).
inline constexpr double kFarthest = 0x1p38;

// Extents of the soup in the rig's axes (x, y, z with y along the spline); node units. BakeError kInvalid if the soup is empty or not finite.
glm::dvec3 rigExtent(const TriangleSoup& soup, Axis axis, const std::string& what);

// The smallest voxel size from `wanted` on that divides `extent_y` into whole voxels: no side gets more of them than it was promised. Below
// eight voxels along y the nudge might exceed an eighth: then `wanted` stays.
double fitVoxelSize(double extent_y, double wanted);

// BakeError kUsage where padding has made a side of `size` longer than a pack can have. `what` names the part.
void checkPadded(const glm::ivec3& size, int pad, const std::string& what);

}  // namespace kelp::bake

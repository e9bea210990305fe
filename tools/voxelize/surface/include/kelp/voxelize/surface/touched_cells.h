// SPDX-License-Identifier: MIT
// Estimates how many voxels a mesh touches, before voxelizing.
#pragma once

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The number of cubes of `edge` voxels (1: voxels, 8: bricks) that triangles touch. Each counts once, even if
// several triangles touch it. Above kCountedCells or kCountedTouches, it counts larger cubes of two sizes and
// extrapolates from the area and length they show. Vertices must be finite and indices in range (makeFrame
// checks both).
double touchedCells(const TriangleSoup& soup, const Frame& frame, double edge);

inline constexpr double kCountedCells = 1 << 24;  // one bit each
// pairs of triangle and cube; 0.1 microseconds each
inline constexpr double kCountedTouches = 1 << 22;

}  // namespace kelp::bake

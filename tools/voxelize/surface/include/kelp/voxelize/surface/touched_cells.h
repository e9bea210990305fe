// SPDX-License-Identifier: MIT
// How many voxels a mesh touches, known before there are voxels.
#pragma once

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Cubes of `edge` voxels (1: voxels, 8: bricks) that triangles touch, each counted once however many do:
// blades narrower than a voxel, both sides of a thin plate, triangles that the file holds twice. Beyond
// kCountedCells or kCountedTouches it counts in larger cubes, and draws out what these say of area and
// length. The triangles' vertices must be finite and there, as makeFrame has found them.
double touchedCells(const TriangleSoup& soup, const Frame& frame, double edge);

inline constexpr double kCountedCells = 1 << 24;  // a bit each
// of all triangles with all cubes: a tenth of a microsecond each
inline constexpr double kCountedTouches = 1 << 22;

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "proxy/triangle.h"
#include "proxy/voxel_surface.h"

namespace kelp::dump {

// Whether every point of a voxel's face is nearer than `most` to one of the triangles. May be false where the
// farthest point is nearer than that by less than an eighth of a voxel.
bool covered(const VoxelFace& face, const std::vector<Triangle>& triangles, double most);

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
// Solid fill by scanlines through voxel centres.
#pragma once

#include <span>

#include "fill_winding.h"

namespace kelp::bake {

// What a voxel is during the fill; anything but kEmpty is solid in the end.
enum : std::uint8_t { kEmpty = 0, kInside = 1, kKept = 2 };

// Sets to kInside the voxels whose centre lies in a solid component (winding number not 0, or where in doubt one half at least; the union of
// components), and to kKept those that
// keep what centres miss: a sheet that a scanline through voxel centres crosses along x, y or z, and a stretch of the inside between two
// centres. So along the three axes a scanline meets a voxel exactly where it meets the mesh. `voxels` holds size.x size.y size.z values.
void fillScanlines(const Topology& mesh, std::span<const Doubt> doubts, const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// What kelp-dump extract writes beside a solid, so that it bakes to the same pack again: two grids of vec3s,
// as tools/kelp-dump/README.md describes them.
#pragma once

#include <vector>

#include "kelp/formats/model.h"
#include "volume_grid.h"

namespace kelp::bake {

// Of a surface voxel.
struct PaintedVoxel {
  std::size_t entry = 0;  // of the palette
  glm::vec3 normal{0};    // in the grid's axes
};
// Grid kelp_attribute: (palette index, octahedral normal u, v) at surface voxels. False where there is none.
bool paintedVoxel(const VolumeSampler& attribute, const glm::dvec3& place, PaintedVoxel& voxel);

// Grid kelp_palette: of entry i, base colour at (i, 0, 0), emitted light at (i, 1, 0), opacity, metallic and
// roughness at (i, 2, 0). Empty where it is not that.
std::vector<Material> paintedPalette(const VolumeGrid& palette);

}  // namespace kelp::bake

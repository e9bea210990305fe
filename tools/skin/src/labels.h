// SPDX-License-Identifier: MIT
// Which voxels belong together: touching components of a mesh that move apart are not glued to each other.
#pragma once

#include <cstdint>
#include <vector>

#include "cage_places.h"
#include "samples.h"

namespace kelp::bake {

struct ComponentLabels {
  std::vector<std::uint16_t> of_components;  // of each component of the mesh
  VoxelLabels voxels;                        // none if all components have one label
};

// A surface voxel has the label of the nearest sample's component, any other that of the nearest surface
// voxel. Components share a label if their weights are alike where they touch.
ComponentLabels labelComponents(const SkinSamples& samples, std::size_t components, const VoxelGrid& whole,
                                int threads);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Normals from occupancy alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/fields/fields.h"

namespace kelp::bake {

// kDetailed: for models built of cubes; kSmooth: for scans
enum class VoxelNormals : std::uint8_t { kDetailed, kSmooth };

// The outward unit normals of these voxels, all of which are solid. The same on any number of threads. Takes
// one more byte for each voxel of the volume.
std::vector<glm::vec3> smoothedNormals(const fields::Occupancy& occupancy,
                                       std::span<const std::uint64_t> voxels, VoxelNormals kind, int threads);

// 1 where a voxel is solid, or empty and enclosed: no path over faces of empty voxels leads out of the
// volume.
std::vector<std::uint8_t> withoutCavities(const fields::Occupancy& occupancy);

}  // namespace kelp::bake

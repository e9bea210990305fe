// SPDX-License-Identifier: MIT
// Normals of voxels that are solid or not, and nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/fields/fields.h"

namespace kelp::bake {

enum class VoxelNormals : std::uint8_t { kDetailed, kSmooth };  // of what was built of cubes; of what was scanned

// The outward unit normals of these voxels, all of them solid. The same on any number of threads. Takes a byte a voxel of the volume besides.
std::vector<glm::vec3> smoothedNormals(const fields::Occupancy& occupancy, std::span<const std::uint64_t> voxels, VoxelNormals kind, int threads);

// 1 where a voxel is solid, or empty and shut in: no way of steps over faces leads from it out of the volume.
std::vector<std::uint8_t> withoutCavities(const fields::Occupancy& occupancy);

}  // namespace kelp::bake

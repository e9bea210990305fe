// SPDX-License-Identifier: MIT
// The voxels that triangles touch: an exact rasterizer on the lattice of the fill.
#pragma once

#include <functional>

#include <glm/vec3.hpp>

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// The voxels of a box of `size` whose closed cube has a point in common with a triangle that is not a cap and
// that `accept(triangle)`, if there is one, lets pass. Decided in integers, without rounding. Dense indices,
// ascending, the same with any number of threads. Takes a bit a voxel of the box beside what it answers.
std::vector<std::uint64_t> touchedVoxels(const Topology& mesh, const glm::ivec3& size, int threads,
                                         const std::function<bool(const SolidTriangle&)>& accept = {});

}  // namespace kelp::bake

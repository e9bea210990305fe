// SPDX-License-Identifier: MIT
// Nothing a mesh has may vanish, however thin.
#pragma once

#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// After the scanlines: adds (as kKept) touched voxels where the mesh is thinner than they can see, such as a
// wire, a grass blade or the tip of an ear. First, voxels that the surface passes through and that have
// nothing solid around them; then, beside those and on thin components, voxels that join what would fall
// apart, alone or in pairs. Thick bodies gain nothing.
void keepThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched,
                   const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels, const Step& step);

// Bit of each of the 27 voxels around (and including) `voxel` that is not empty: x + 3 (y + 3 z), each 0 ..
// 2; the outside is empty.
constexpr std::uint32_t kCentreBit = 1u << 13;
std::uint32_t neighbourMask(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size,
                            const glm::ivec3& voxel);

// Whether the cells of such a mask (without the middle) hang together, by corners at least.
bool hangTogether(std::uint32_t mask);

}  // namespace kelp::bake

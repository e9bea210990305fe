// SPDX-License-Identifier: MIT
// Keeps parts of the mesh that are too thin for scanlines.
#pragma once

#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// Runs after the scanlines. Adds voxels of `touched` (touchedVoxels of the mesh), as kKept, where the mesh is
// too thin for them: a wire, a grass blade, the tip of an ear. First it adds voxels that the surface passes
// through and that have nothing solid around them. Then, beside those and on thin components, it adds single
// voxels or pairs that connect pieces. Thick bodies gain nothing.
void keepThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched,
                   const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels, const Step& step);

// Which of the 27 voxels around `voxel`, itself included, are not empty: bit x + 3 (y + 3 z) with x, y, z
// from 0 to 2. Voxels outside the grid are empty.
constexpr std::uint32_t kCentreBit = 1u << 13;
std::uint32_t neighbourMask(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size,
                            const glm::ivec3& voxel);

// Whether the voxels of such a mask, without the centre, are connected by faces, edges or corners.
bool hangTogether(std::uint32_t mask);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Decides which voxels are solid, step by step; voxelize.cpp calls the steps in order.
#pragma once

#include <cstdint>
#include <vector>

#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/voxelize/surface/triangle_bvh.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// Half the diagonal of a voxel, in voxels.
constexpr double kHalfDiagonal = 0.8660254037844387;

// A voxel's state during the fill. Everything except kEmpty ends as solid.
enum : std::uint8_t { kEmpty = 0, kInside = 1, kKept = 2 };

// Counts of a component along the scanlines. Integers, so that their sum does not depend on the order.
struct Scanned {
  std::int64_t faces = 0;  // where scanlines along x, y and z enter or leave it
  // of `faces`: inside another solid component, or where one begins or ends
  std::int64_t shared = 0;
  // Only along x. Lengths in units of 2^-kLatticeBits voxel.
  std::int64_t centers = 0;  // voxel centers inside it
  std::int64_t length = 0;   // of scanlines inside it
  std::int64_t wound = 0;    // length times winding number: larger where the component overlaps itself
};

// Sets a voxel to kInside if its center is inside a solid component: winding number not 0. Sets it to kKept
// where the centers miss something: a sheet that a scanline through voxel centers crosses along x, y or z, or
// a stretch of the inside between two centers. So along the three axes a scanline meets a solid voxel exactly
// where it meets the mesh. `voxels` holds size.x * size.y * size.z values. Returns the counts of each
// component, as if its caps were part of the mesh.
std::vector<Scanned> fillScanlines(const Topology& mesh, const glm::ivec3& size, int threads,
                                   std::vector<std::uint8_t>& voxels);

// Runs after the scanlines. Adds voxels of `touched` (touchedVoxels of the mesh), as kKept, where the mesh is
// too thin for them: a wire, a grass blade, the tip of an ear. First it adds voxels that the surface passes
// through and that have nothing solid around them. Then, beside those and on thin components, it adds single
// voxels or pairs that connect pieces. Thick bodies gain nothing.
void keepThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched,
                   const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels, const Step& step);

// A bit for each of the 27 voxels around `voxel`, itself included, that is not empty: bit x + 3 (y + 3 z)
// with x, y, z from 0 to 2. Voxels outside the grid are empty.
constexpr std::uint32_t kCenterBit = 1u << 13;
std::uint32_t neighborMask(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size,
                           const glm::ivec3& voxel);

// True if the voxels of such a mask, without the center, are connected by faces, edges or corners.
bool hangTogether(std::uint32_t mask);

// If two voxels of a thin part touch only along an edge, a ray through that edge passes between them, because
// tracing is exact only to 1/256 voxel. Where the mesh passes such an edge, the nearer of the two empty
// voxels beside the edge becomes kKept.
void closeDiagonalGaps(const Topology& mesh, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                       std::vector<std::uint8_t>& voxels);

// The last step of the fill gives slender bodies the volume of their mesh. Removes voxels from solid
// components whose voxels have more than the component's volume, or adds voxels to those with less, until the
// sum is within 0.5 %. Large bodies are within it already, because rounding evens out, so they do not change.
// Two things do: twigs and walls a few voxels thick whose two sides round the same way everywhere (1.5 voxels
// become two), and voxels that the scanlines kept at the edges of a slender body.
//
// Voxels nearest to the surface change first; none changes whose center is half a voxel away or more. A flat
// side along the grid changes as a whole or not at all. A voxel is removed only if its body continues beneath
// it. No change may connect, separate, open or close anything, edges between voxels included, so plates of
// one voxel, wires and tips lose nothing. No point of the mesh gets farther than 1.6 voxels from the center
// of a solid voxel. Left alone: sheets, bodies inside or touching others (only the outside of the union is
// seen), bodies with caps on more than 1 % of their surface, and bodies thinner than a voxel.
//
// A component's volume is that of its triangles and caps, minus what `scanned` counted twice. One thread
// decides, in a fixed order.
void matchVolumes(const Topology& mesh, const std::vector<Scanned>& scanned, const TriangleBvh& bvh,
                  const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels, const Step& step);

}  // namespace kelp::bake

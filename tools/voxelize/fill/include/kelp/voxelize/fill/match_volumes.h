// SPDX-License-Identifier: MIT
// Gives slender bodies the volume of their mesh.
#pragma once

#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// The last step of the fill. Removes voxels from solid components whose voxels have more than the component's
// volume, or adds voxels to those with less, until the sum is within 0.5 %. Large bodies are within it
// already, because rounding evens out, so nothing changes. What changes: twigs and walls a few voxels thick,
// where both sides lie on the grid in the same way all over (1.5 voxels become two), and voxels that
// scanlines keep where a slender body is seen edge-on.
//
// Voxels nearest to the surface change first; none changes whose centre is half a voxel away or more. A flat
// side along the grid changes as a whole or not at all. A voxel is removed only if its body continues beneath
// it. No change may connect, separate, open or close anything, edges between voxels included, so plates of
// one voxel, wires and tips lose nothing. No point of the mesh gets farther than 1.6 voxels from the centre
// of a solid voxel. Left alone: sheets, bodies inside or touching others (only the outside of the union is
// seen), bodies with caps on more than 1 % of their surface, and bodies thinner than a voxel.
//
// A component's volume is that of its triangles and caps, minus what `scanned` counted twice. One thread
// decides, in a fixed order.
void matchVolumes(const Topology& mesh, const std::vector<Scanned>& scanned, const TriangleBvh& bvh,
                  const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels, const Step& step);

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Slender bodies have the volume of their mesh.
#pragma once

#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// The last of the fill: takes voxels from solid components that have more than their volume, or adds some to
// those that have less, until all together are within half a percent. Where chance evens out they are so
// anyway, and nothing changes. What does change is twigs and walls of a few voxels, whose two sides lie alike
// on the grid all over (1.5 voxels become two), and the voxels that scanlines keep where a slender body is
// seen edge-on.
//
// Those nearest to the surface change first, and flat sides along the grid as a whole or not at all; none
// that is half a voxel away. A voxel goes only where its body goes on beneath it, and changes only where that
// joins, parts, opens and closes nothing, an edge that rays slip through included: plates of one voxel, wires
// and tips lose nothing. Voxels with a point of the mesh in them, and a solid one in themselves or across a
// face, still have one: no point gets farther than 1.6 voxels from a solid one's centre. Sheets stay, and so
// do bodies that lie in or against others, since only the outside of the union is seen, that have caps on
// more than a hundredth of their surface, or that are thinner than a voxel.
//
// The volume is that of the component's triangles and caps, less what `scanned` met of it twice. The choice
// is made by one thread, in one order.
void matchVolumes(const Topology& mesh, const std::vector<Scanned>& scanned, const TriangleBvh& bvh,
                  const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels, const Step& step);

}  // namespace kelp::bake

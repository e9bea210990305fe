// SPDX-License-Identifier: MIT
// Where a cap is no good guess at what is missing.
#pragma once

#include <vector>

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// A voxel where the caps of a solid component may decide wrongly. The generalised winding number of the
// component's own triangles there is the integer winding number of the capped component minus `caps`.
struct Doubt {
  std::uint64_t voxel = 0;  // dense index
  std::uint32_t component = 0;
  // solid angle of its caps at the voxel's centre / 4 pi, signed; beyond one half
  double caps = 0;
};

// All of them, by voxel and component. Elsewhere the integer winding number is on the same side of one half
// as the generalised one. Source: Jacobson, Kavan, Sorkine-Hornung, "Robust Inside-Outside Segmentation using
// Generalized Winding Numbers", 2013.
std::vector<Doubt> findDoubts(const Topology& mesh, const glm::ivec3& size, int threads);

}  // namespace kelp::bake

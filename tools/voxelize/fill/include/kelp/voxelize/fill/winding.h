// SPDX-License-Identifier: MIT
// Where the caps of holes may be wrong about inside and outside.
#pragma once

#include <vector>

#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// A voxel where the caps of a solid component may decide wrongly. The generalised winding number of the
// component's own triangles there is the integer winding number of the capped component minus `caps`.
struct Doubt {
  std::uint64_t voxel = 0;  // dense index
  std::uint32_t component = 0;
  // signed solid angle of its caps at the voxel's centre, over 4 pi; its magnitude is above one half
  double caps = 0;
};

// All such voxels, sorted by voxel and component. Elsewhere the integer winding number is on the same side of
// one half as the generalised one. Source: Jacobson, Kavan, Sorkine-Hornung, "Robust Inside-Outside
// Segmentation using Generalized Winding Numbers", 2013.
std::vector<Doubt> findDoubts(const Topology& mesh, const glm::ivec3& size, int threads);

}  // namespace kelp::bake

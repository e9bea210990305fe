// SPDX-License-Identifier: MIT
// Fog of a sparse grid's densities, and of another one's heat.
#pragma once

#include "volume_lattice.h"

namespace kelp::bake {

// What a grid of densities or heat holds.
struct FogBox {
  IndexBox box;                  // of voxels above 0
  double most = 0, voxels = 0;   // the greatest value; how many are above 0
  std::uint64_t negative = 0, not_finite = 0;  // voxels; what counts as 0
};
FogBox fogBox(const SparseGrid& grid);

// The lattice for it: the grid's own voxels, or new ones that hold all of it.
Lattice fogLattice(const InputFiles& files, const FogBox& box, const glm::dmat4& index_to_rig, const Settings& settings);

// The lattice of `grid` in the index space of another one: part voxels to that.
glm::dmat4 indexOf(const SparseGrid& other, const SparseGrid& grid, const Lattice& lattice);

// Densities per length of the grid's space; `most` as in its FogBox. `heat` may be null; most_heat is what is the ramp's end. to_node of the result is the caller's.
FogGrid sampleFog(const InputFiles& files, const std::string& place, const SparseGrid& grid, const FogBox& box, const Lattice& lattice, const SparseGrid* heat, double most_heat, const Settings& settings);

}  // namespace kelp::bake

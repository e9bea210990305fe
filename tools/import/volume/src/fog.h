// SPDX-License-Identifier: MIT
// Makes fog of a grid's densities and, if there is one, of another grid's heat.
#pragma once

#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"
#include "lattice.h"

namespace kelp::bake {

// The range of a grid of densities or heat.
struct FogBox {
  IndexBox box;                                // around the voxels above 0
  double most = 0, voxels = 0;                 // the greatest value; the number of voxels above 0
  std::uint64_t negative = 0, not_finite = 0;  // numbers of voxels that count as 0
};
FogBox fogBox(const VolumeGrid& grid);

// The lattice for such a grid: its own voxels, or new ones that contain all of its values.
Lattice fogLattice(const InputFiles& files, const FogBox& box, const VolumeGrid& grid,
                   const glm::dmat4& index_to_rig, const ImportSettings& settings);

// Voxels of the part, on the lattice of `grid`, -> index space of another grid.
glm::dmat4 indexOf(const VolumeGrid& other, const VolumeGrid& grid, const Lattice& lattice);

// Densities are per length of the grid's space. `heat` may be null; `most_heat` is the heat at the ramp's
// end. `place` is the grid, for errors. The caller sets to_node of the result.
FogGrid sampleFog(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                  const FogBox& box, const Lattice& lattice, const VolumeGrid* heat, double most_heat,
                  const ImportSettings& settings);

}  // namespace kelp::bake

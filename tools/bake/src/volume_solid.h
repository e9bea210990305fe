// SPDX-License-Identifier: MIT
// A solid of a sparse grid's values.
#pragma once

#include "volume_lattice.h"
#include "volume_rule.h"

namespace kelp::bake {

struct SolidBox {
  IndexBox box;                 // ends at the surface: the outermost crossings of the isovalue along each axis
  double faces = 0, solid = 0;  // of solid voxels towards empty ones; solid voxels
};
// `place` is the grid, for errors: kInvalid where nothing is solid.
SolidBox solidBox(const InputFiles& files, const std::string& place, const SparseGrid& grid, const VolumeRule& rule);

struct ColorCounts {
  std::uint64_t missing = 0, clipped = 0;  // surface voxels that no active value of the colour grid is near; that are brighter than 1 or darker than 0
};
// Grids beside the one that is solid, each of which may be null.
struct SolidLooks {
  const SparseGrid* color = nullptr;
  const SparseGrid* attribute = nullptr;  // VolumeChoice::attribute: the normals of voxels that are the lattice's own
};
// to_node of the result is the caller's.
VoxelGrid sampleSolid(const InputFiles& files, const SparseGrid& grid, const VolumeRule& rule, const Lattice& lattice, const SolidLooks& looks, int threads, ColorCounts& counts);

}  // namespace kelp::bake

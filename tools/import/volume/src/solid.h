// SPDX-License-Identifier: MIT
// A solid of a sparse grid's values.
#pragma once

#include "kelp/import/core/source_model.h"
#include "lattice.h"
#include "paint.h"
#include "solid_rule.h"

namespace kelp::bake {

struct SolidBox {
  // ends at the surface: the outermost crossings of the isovalue along each axis
  IndexBox box;
  double faces = 0, solid = 0;  // of solid voxels towards empty ones; solid voxels
};
// `place` is the grid, for errors: kInvalid where nothing is solid.
SolidBox solidBox(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                  const VolumeRule& rule);

struct ColorCounts {
  // surface voxels that no active value of the colour grid is near; that are brighter than 1 or darker than 0
  std::uint64_t missing = 0, clipped = 0;
  // that SolidLooks::attribute says nothing of, or whose colour is not the one of its entry: somebody has
  // edited the grids
  std::uint64_t unpainted = 0;
};
// What lies beside the grid that is solid.
struct SolidLooks {
  const VolumeGrid* color = nullptr;      // may be null
  const VolumeGrid* attribute = nullptr;  // may be null; only where the lattice's voxels are the grid's own
  // what attribute names entries of: materials and SurfaceSample::source of the voxels that are painted
  std::vector<Material> palette;
};
// to_node of the result is the caller's.
VoxelGrid sampleSolid(const InputFiles& files, const VolumeGrid& grid, const VolumeRule& rule,
                      const Lattice& lattice, const SolidLooks& looks, int threads, ColorCounts& counts);

}  // namespace kelp::bake

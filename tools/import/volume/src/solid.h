// SPDX-License-Identifier: MIT
// A solid of a sparse grid's values: the rule of what is solid, its box, its voxels and their look.
#pragma once

#include <vector>

#include "kelp/formats/model.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"
#include "lattice.h"

namespace kelp::bake {

// The meaning of a grid's numbers: solid or empty, or the density of fog.
struct VolumeRule {
  bool fog = false;
  bool below = true;  // solid where the value is at most iso; else at least
  double iso = 0;
  bool binary = false;  // values are 0 and 1: there is no field to take normals from

  bool solid(double value) const { return below ? value <= iso : value >= iso; }     // a NaN is not
  double distance(double value) const { return below ? value - iso : iso - value; }  // at most 0 in the solid
};

// From the grid's type and class, and from its values where these say nothing; `notices` gets what had to be
// guessed. ToolError kUsage for settings that do not go together, kInvalid for a background that would fill
// all space.
VolumeRule volumeRule(const InputFiles& files, const GridHeader& header, const VolumeGrid& grid,
                      const ImportSettings& settings, std::vector<std::string>& notices);

// The look that kelp-dump extract writes beside a solid, so that it bakes to the same pack again: two grids
// of vec3s, as tools/kelp-dump/EXTRACT.md describes them.

// Of a surface voxel.
struct PaintedVoxel {
  std::size_t entry = 0;  // of the palette
  glm::vec3 normal{0};    // in the grid's axes
};
// Grid kelp_attribute: (palette index, octahedral normal u, v) at surface voxels. False where there is none.
bool paintedVoxel(const VolumeSampler& attribute, const glm::dvec3& place, PaintedVoxel& voxel);

// Grid kelp_palette: of entry i, base color at (i, 0, 0), emitted light at (i, 1, 0), opacity, metallic and
// roughness at (i, 2, 0). Empty where it is not that.
std::vector<Material> paintedPalette(const VolumeGrid& palette);

struct SolidBox {
  // ends at the surface: the outermost crossings of the isovalue along each axis
  IndexBox box;
  double faces = 0, solid = 0;  // of solid voxels towards empty ones; solid voxels
};
// `place` is the grid, for errors: kInvalid where nothing is solid.
SolidBox solidBox(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                  const VolumeRule& rule);

struct ColorCounts {
  // surface voxels that no active value of the color grid is near; that are brighter than 1 or darker than 0
  std::uint64_t missing = 0, clipped = 0;
  // that SolidLooks::attribute says nothing of, or whose color is not the one of its entry: somebody has
  // edited the grids
  std::uint64_t unpainted = 0;
};
// The other grids that give a solid its look.
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

// SPDX-License-Identifier: MIT
// Voxels of the bind pose in the grid of a swept part.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kelp/fields/fields.h"
#include "kelp/voxelize/surface/look.h"
#include "kelp/voxelize/surface/triangle_bvh.h"
#include "share.h"
#include "sweep.h"

namespace kelp::bake {

// The surface of a mesh in voxels of the whole.
class MeshSurface {
 public:
  MeshSurface(const SourceModel& model, const TriangleSoup& soup, const Frame& frame)
      : mesh_(analyze(soup, frame, Fill::kAuto)), bvh_(mesh_), look_(model, soup, mesh_) {
    look_.openCutOuts(mesh_);
  }

  // Of the mesh, not of what closes its holes.
  Nearest nearest(const glm::dvec3& point) const;
  const SurfaceLook& look() const { return look_; }
  // True if the point is inside; nullopt where the nearest surface has no inside.
  std::optional<bool> contains(const glm::dvec3& point) const;

 private:
  Topology mesh_;
  TriangleBvh bvh_;
  SurfaceLook look_;
};

// The voxels `list` of the whole grid, straightened. A voxel of the part is solid if its center is within the
// surface there; and where a thin wall would be lost by that, the voxel that its voxel's center goes to.
VoxelGrid straightGrid(const SkinSweep& sweep, const SkinSpace& space, const MeshSurface& surface,
                       const std::vector<std::uint64_t>& list, const VoxelOwners& owners,
                       const VoxelGrid& whole, int threads);

// Away from the solid around a voxel. Zero if it is as solid on all sides.
glm::vec3 openDirection(const fields::Occupancy& occupancy, const glm::ivec3& at);

}  // namespace kelp::bake

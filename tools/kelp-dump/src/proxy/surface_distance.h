// SPDX-License-Identifier: MIT
// Distances between a mesh and the faces of voxels, both ways. All lengths in voxels.
#pragma once

#include <vector>

#include "proxy/box_tree.h"
#include "proxy/proxy_mesh.h"
#include "proxy/triangle.h"
#include "proxy/voxel_surface.h"

namespace kelp::dump {

class SurfaceDistance {
 public:
  // Both must outlive this object. At least one face.
  SurfaceDistance(const LevelVoxels& level, const std::vector<VoxelFace>& faces);

  // Whether no point of the triangle is farther than `most` from the faces. If the farthest one is nearer
  // than that by less than a fifteenth of it, the answer may be false.
  bool within(const Triangle& triangle, double most) const;

  // Upper bounds of the largest distance from a point of the mesh to the faces, and from a point of the faces
  // to the mesh, for meshes that should be within `error`. They are too large by at most tolerance(error).
  static double tolerance(double error) { return std::min(0.01, error / 100); }
  double fromMesh(const ProxyMesh& mesh, double error) const;
  double toMesh(const ProxyMesh& mesh, double error) const;

 private:
  BoxTree::Nearest nearest(const glm::dvec3& p, double limit) const;
  double bound(const glm::dvec3& p) const;

  const LevelVoxels& level_;
  const std::vector<VoxelFace>& faces_;
  BoxTree tree_;
};

}  // namespace kelp::dump

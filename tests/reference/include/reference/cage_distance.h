// SPDX-License-Identifier: MIT
// How far the solid of a caged part is, in double precision: the faces of its voxels, cut by tetrahedra, are
// polygons, of which the nearest point is found by trying all that may be nearer. Of what the runtime does it
// shares nothing.
#pragma once

#include "reference/cage_truth.h"

namespace kelp::reference {

class CageDistance {
 public:
  // Level 0, without coarser voxels. `truth` must outlive this.
  explicit CageDistance(const CageTruth& truth);

  bool inside(const glm::dvec3& p) const;
  // The nearest point of the surface; inside of the solid too. There must be one.
  glm::dvec3 nearest(const glm::dvec3& p) const;

 private:
  struct Triangle {
    glm::dvec3 corners[3];
  };
  // Two children, one after the other from `first` on, or `count` triangles.
  struct Node {
    glm::dvec3 low{0}, high{0};
    std::size_t first = 0, count = 0;
  };

  void addVoxel(const CageTruth::Cube& cube, const glm::ivec3& voxel);
  void add(std::vector<glm::dvec3> polygon, const CageTruth::Tetrahedron& tetrahedron);
  void build(std::size_t node, std::size_t first, std::size_t count);
  void look(std::size_t node, const glm::dvec3& p, double& best2, glm::dvec3& found) const;

  const CageTruth& truth_;
  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace kelp::reference

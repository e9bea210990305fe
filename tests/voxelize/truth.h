// SPDX-License-Identifier: MIT
// The truth about a triangle soup, by brute force in double precision; shares no code with the baker.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kelp/bake/bake.h"

namespace kelp::test {

struct NearestPoint {
  double distance = 0;
  std::size_t triangle = 0;
  glm::dvec3 weights{1, 0, 0};
};

// The triangles of a soup in the voxels of a frame.
class MeshTruth {
 public:
  MeshTruth(const bake::TriangleSoup& soup, const bake::Frame& frame);

  std::size_t triangles() const { return corners_.size(); }
  const std::array<glm::dvec3, 3>& corners(std::size_t triangle) const { return corners_[triangle]; }
  double area() const { return total_area_; }

  // Sum of signed tetrahedra (divergence theorem), voxels^3: the volume, if the mesh is closed, wound outward
  // and free of overlaps.
  double signedVolume() const;
  // Generalized winding number (Jacobson et al. 2013): signed solid angle / 4 pi, by the formula of Van
  // Oosterom and Strackee. Every triangle is looked at.
  double winding(const glm::dvec3& p) const;
  // The same for each piece (what shares corners): the largest magnitude. Pieces that are inside out take
  // nothing from the others.
  double windingOfPieces(const glm::dvec3& p) const;
  // The nearest point of the mesh. Triangles lie in the cells of a grid that their boxes touch; cells are
  // looked at shell by shell.
  NearestPoint nearest(const glm::dvec3& p) const;
  // Points spread evenly over the surface.
  std::vector<glm::dvec3> sample(std::size_t count, std::uint32_t seed) const;
  // Edges (of equal positions) that do not belong to two triangles.
  std::size_t openEdges() const;

 private:
  double solidAngle(std::size_t triangle, const glm::dvec3& p) const;
  void findPieces();
  std::size_t cell(const glm::ivec3& c) const {
    return static_cast<std::size_t>(c.x) +
           static_cast<std::size_t>(cells_.x) *
               (static_cast<std::size_t>(c.y) +
                static_cast<std::size_t>(cells_.y) * static_cast<std::size_t>(c.z));
  }

  std::vector<std::array<glm::dvec3, 3>> corners_;
  std::vector<double> area_up_to_;
  std::vector<std::uint32_t> piece_;  // of each triangle
  std::size_t pieces_ = 0;
  double total_area_ = 0;
  glm::ivec3 cells_{1};
  std::vector<std::vector<std::uint32_t>> grid_;
};

// The frame of a soup that stands along +y, with that many voxels along the longest side of its triangles.
bake::Frame frameOf(const bake::TriangleSoup& soup, int resolution);

// Distance of a point from a triangle, and the weights of the nearest point's corners: the plane if the foot
// lies within, else the sides.
double distanceToTriangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t, glm::dvec3& weights);

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// OpenMesh's error quadrics (Garland and Heckbert 1997). OpenMesh's own module leaves the vertex at one end
// of the edge; this one knows where the error is least, which takes half the triangles.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <OpenMesh/Core/Geometry/QuadricT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace kelp::dump {

template <class MeshT>
class PlacedQuadrics : public OpenMesh::Decimater::ModBaseT<MeshT> {
 public:
  DECIMATING_MODULE(PlacedQuadrics, MeshT, PlacedQuadrics);
  using Point = typename MeshT::Point;

  explicit PlacedQuadrics(MeshT& mesh) : Base(mesh, false) {}

  void initialize() override {
    const Mesh& mesh = Base::mesh();
    quadrics_.assign(mesh.n_vertices(), Quadric());
    for (const auto face : mesh.faces()) {
      auto vertex = mesh.cfv_iter(face);
      const Quadric quadric =
          Quadric(mesh.calc_face_normal(face), mesh.point(*vertex)) * mesh.calc_face_area(face);
      for (; vertex.is_valid(); ++vertex) quadrics_[at(*vertex)] += quadric;
    }
  }
  void place(const Point& place) { place_ = place; }
  // The error at place(). Among equals, short edges go first: so triangles grow evenly.
  float collapse_priority(const CollapseInfo& collapse) override {
    const double length = (collapse.p0 - collapse.p1).sqrnorm();
    return static_cast<float>(std::max(0.0, sum(collapse)(place_)) + kLength * length * length);
  }
  void postprocess_collapse(const CollapseInfo& collapse) override {
    quadrics_[at(collapse.v1)] += quadrics_[at(collapse.v0)];
  }

  // Where the error is least. What it does not decide (along a plane, along an edge) is near the middle.
  Point best(const CollapseInfo& collapse) const {
    const Quadric q = sum(collapse);
    const Point middle = (collapse.p0 + collapse.p1) * 0.5;
    const double weight = kPull * (q.a() + q.e() + q.h());
    const glm::dmat3 matrix(q.a() + weight, q.b(), q.c(),  //
                            q.b(), q.e() + weight, q.f(),  //
                            q.c(), q.f(), q.h() + weight);
    if (!(glm::determinant(matrix) > 0)) return middle;
    const glm::dvec3 best =
        glm::inverse(matrix) *
        glm::dvec3(weight * middle[0] - q.d(), weight * middle[1] - q.g(), weight * middle[2] - q.i());
    return {best.x, best.y, best.z};
  }

 private:
  using Quadric = OpenMesh::Geometry::QuadricT<double>;
  static constexpr double kLength = 1e-5, kPull = 1e-3;

  static std::size_t at(OpenMesh::VertexHandle vertex) { return static_cast<std::size_t>(vertex.idx()); }
  Quadric sum(const CollapseInfo& collapse) const {
    Quadric sum = quadrics_[at(collapse.v0)];
    return sum += quadrics_[at(collapse.v1)];
  }

  std::vector<Quadric> quadrics_;
  Point place_{0, 0, 0};
};

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#include "patch.h"

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace kelp::bake {
namespace {

using Corners = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = 0xffffffffu;

std::vector<Corners> triangulate(std::span<const glm::dvec3> p) {
  const std::size_t n = p.size();
  // least[i n + k]: the area of the best triangulation of the corners i .. k; apex: the corner that its
  // triangle at the edge k, i has.
  std::vector<double> least(n * n, 0.0);
  std::vector<std::uint32_t> apex(n * n, kNone);
  for (std::size_t reach = 2; reach < n; ++reach) {
    for (std::size_t i = 0; i + reach < n; ++i) {
      const std::size_t k = i + reach;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t j = i + 1; j < k; ++j) {
        const double area =
            least[i * n + j] + least[j * n + k] + 0.5 * glm::length(glm::cross(p[j] - p[i], p[k] - p[i]));
        if (area < best) {
          best = area;
          apex[i * n + k] = static_cast<std::uint32_t>(j);
        }
      }
      least[i * n + k] = best;
    }
  }
  std::vector<Corners> triangles;
  std::vector<std::array<std::uint32_t, 2>> spans{{0, static_cast<std::uint32_t>(n - 1)}};
  while (!spans.empty()) {
    const auto [i, k] = spans.back();
    spans.pop_back();
    if (k - i < 2) continue;
    const std::uint32_t j = apex[i * n + k];
    triangles.push_back({i, j, k});
    spans.push_back({i, j});
    spans.push_back({j, k});
  }
  return triangles;
}

double cotangent(const glm::dvec3& at, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::dot(b - at, c - at) / (glm::length(glm::cross(b - at, c - at)) + 1e-12);
}

// The edge becomes the other diagonal of its two triangles, if the angles that it is opposite to add up to
// more than half a turn.
bool flipLong(HalfEdgeMesh& mesh, OpenMesh::SmartEdgeHandle edge) {
  if (edge.is_boundary()) return false;
  const glm::dvec3 a = pointOf(mesh, edge.v0()), b = pointOf(mesh, edge.v1()),
                   c = pointOf(mesh, edge.h0().next().to()), d = pointOf(mesh, edge.h1().next().to());
  if (cotangent(c, a, b) + cotangent(d, a, b) > -1e-6 || !mesh.is_flip_ok(edge)) return false;
  mesh.flip(edge);
  return true;
}

// In the plane this ends with the Delaunay triangulation; in space it might go round in circles.
void flipAll(HalfEdgeMesh& mesh) {
  constexpr int kRounds = 16;
  bool any = true;
  for (int round = 0; round < kRounds && any; ++round) {
    any = false;
    for (const OpenMesh::SmartEdgeHandle edge : mesh.edges()) any = flipLong(mesh, edge) || any;
  }
}

// At its centre, if that is far enough from all three corners.
bool splitLarge(HalfEdgeMesh& mesh, OpenMesh::SmartFaceHandle face, double length) {
  glm::dvec3 centre(0);
  for (const OpenMesh::VertexHandle vertex : face.vertices()) centre += pointOf(mesh, vertex) / 3.0;
  for (const OpenMesh::VertexHandle vertex : face.vertices()) {
    if (glm::distance(pointOf(mesh, vertex), centre) < length * 0.7071067811865476) return false;
  }
  mesh.split(face, toPoint(centre));
  return true;
}

void refine(Patch& patch, double length) {
  // A disc of n edges of this length has some n^2 / (4 pi) points within; whatever the polygon does, it ends.
  const std::size_t most = patch.rim + patch.rim * patch.rim / 4;
  HalfEdgeMesh& mesh = patch.mesh;
  flipAll(mesh);
  for (bool any = true; any;) {
    any = false;
    const std::size_t count = mesh.n_faces();
    for (std::size_t i = 0; i < count && mesh.n_vertices() < most; ++i) {
      const OpenMesh::FaceHandle face = mesh.face_handle(static_cast<unsigned>(i));
      any = splitLarge(mesh, OpenMesh::make_smart(face, mesh), length) || any;
    }
    if (any) flipAll(mesh);
  }
}

}  // namespace

Patch spanPolygon(std::span<const glm::dvec3> polygon) {
  Patch patch;
  patch.rim = static_cast<std::uint32_t>(polygon.size());
  double length = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    patch.mesh.add_vertex(toPoint(polygon[i]));
    length += glm::distance(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  for (const auto& [a, b, c] : triangulate(polygon))
    patch.mesh.add_face(patch.mesh.vertex_handle(a), patch.mesh.vertex_handle(b),
                        patch.mesh.vertex_handle(c));
  refine(patch, length / static_cast<double>(polygon.size()));
  return patch;
}

}  // namespace kelp::bake

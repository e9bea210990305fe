// SPDX-License-Identifier: MIT
#include "proxy/proxy_mesh.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>
#include <glm/glm.hpp>

#include "kelp/common/error.h"
#include "proxy/voxel_faces.h"

namespace kelp::dump {
namespace {

namespace Om = OpenMesh;

constexpr int kSmoothingSteps = 10;
constexpr float kMostTurn = 75;  // degrees that a collapse may turn a triangle by

ProxyMesh::Point pointOf(const glm::vec3& p) { return {p.x, p.y, p.z}; }

// A number for a place in a grid of at most 2^20 a side.
std::uint64_t keyOf(const glm::ivec3& v, int axis = 0) {
  std::uint64_t key = static_cast<std::uint64_t>(axis);
  for (int i = 0; i < 3; ++i) key = key << 20 | static_cast<std::uint64_t>(v[i]);
  return key;
}

// Marching cubes on the grid of the voxels' middles. A vertex stands where an edge of that grid leaves the
// solid: in the middle of a voxel's face.
class SurfaceBuilder {
 public:
  explicit SurfaceBuilder(const LevelVoxels& level) : level_(level) {
    for (int side = 0; side < 6; ++side) sides_[static_cast<std::size_t>(side)] = voxelFace(side);
    eachFace(level, [&](const glm::ivec3& voxel, const VoxelFace& face) {
      // The cubes around the middle of the face; cube v is between the middles of voxels v - 1 and v.
      for (const glm::ivec3& corner : face.corners)
        if (done_.insert(keyOf(voxel + corner)).second) addCube(voxel + corner);
    });
  }
  ProxyMesh take() { return std::move(mesh_); }

 private:
  using Edge = std::pair<glm::ivec3, glm::ivec3>;  // of a cube: from its solid corner to its empty one

  // On each side of the cube, a line cuts off each run of solid corners. The lines make closed polygons. Both
  // cubes at a side draw the same lines on it, so all edges meet; and each vertex is in one polygon of each
  // of the four cubes around it.
  void addCube(const glm::ivec3& cube) {
    std::vector<std::pair<Edge, Edge>> lines;
    for (const VoxelFace& side : sides_) {
      const auto corner = [&](std::size_t i) { return side.corners[i % 4]; };
      const auto solid = [&](std::size_t i) { return level_.solid(cube - 1 + corner(i)); };
      for (std::size_t first = 0; first < 4; ++first) {
        if (!solid(first) || solid(first + 3)) continue;  // not the first of a run
        std::size_t last = first;
        while (solid(last + 1)) ++last;
        lines.push_back({{corner(first), corner(first + 3)}, {corner(last), corner(last + 1)}});
      }
    }
    while (!lines.empty()) {
      std::vector<Om::VertexHandle> polygon;
      const Edge first = lines.back().first;
      Edge at = first;
      do {
        const auto line =
            std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.first == at; });
        polygon.push_back(vertexOn(cube, at));
        at = line->second;
        lines.erase(line);
      } while (at != first);
      addPolygon(polygon);
    }
  }

  Om::VertexHandle vertexOn(const glm::ivec3& cube, const Edge& edge) {
    const glm::ivec3 low = glm::min(edge.first, edge.second), along = glm::abs(edge.second - edge.first);
    Om::VertexHandle& vertex = vertices_[keyOf(cube + low, along.y + 2 * along.z)];
    if (!vertex.is_valid())
      vertex = mesh_.add_vertex(pointOf(glm::vec3(cube) - 0.5f + 0.5f * glm::vec3(edge.first + edge.second)));
    return vertex;
  }

  // Diagonals of larger polygons could lie on a side of the cube, where the next cube may have the same one.
  void addPolygon(const std::vector<Om::VertexHandle>& polygon) {
    const std::size_t count = polygon.size();
    if (count <= 4) {
      for (std::size_t i = 1; i + 1 < count; ++i) mesh_.add_face(polygon[0], polygon[i], polygon[i + 1]);
      return;
    }
    ProxyMesh::Point middle(0);
    for (const Om::VertexHandle vertex : polygon) middle += mesh_.point(vertex) / static_cast<float>(count);
    const Om::VertexHandle center = mesh_.add_vertex(middle);
    for (std::size_t i = 0; i < count; ++i) mesh_.add_face(center, polygon[i], polygon[(i + 1) % count]);
  }

  const LevelVoxels& level_;
  std::array<VoxelFace, 6> sides_;
  ProxyMesh mesh_;
  std::unordered_set<std::uint64_t> done_;
  std::unordered_map<std::uint64_t, Om::VertexHandle> vertices_;
};

void requestStatus(ProxyMesh& mesh) {
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_face_normals();
}

}  // namespace

ProxyMesh surfaceOf(const LevelVoxels& level) { return SurfaceBuilder(level).take(); }

void smooth(ProxyMesh& mesh, double most) {
  requestStatus(mesh);
  mesh.request_vertex_normals();
  mesh.update_normals();
  Om::Smoother::JacobiLaplaceSmootherT<ProxyMesh> smoother(mesh);
  smoother.initialize(smoother.Tangential_and_Normal, smoother.C0);
  smoother.set_absolute_local_error(static_cast<float>(most));
  smoother.smooth(kSmoothingSteps);
}

void decimate(ProxyMesh& mesh, double most) {
  requestStatus(mesh);
  mesh.update_face_normals();
  Om::Decimater::DecimaterT<ProxyMesh> decimater(mesh);
  Om::Decimater::ModQuadricT<ProxyMesh>::Handle quadric;
  Om::Decimater::ModNormalFlippingT<ProxyMesh>::Handle flipping;
  Om::Decimater::ModHausdorffT<ProxyMesh>::Handle hausdorff;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.add(hausdorff);
  decimater.module(quadric).unset_max_err();
  decimater.module(flipping).set_max_normal_deviation(kMostTurn);
  decimater.module(hausdorff).set_tolerance(static_cast<float>(most));
  decimater.initialize();
  decimater.decimate();
  mesh.garbage_collection();
}

std::vector<Triangle> trianglesOf(const ProxyMesh& mesh) {
  std::vector<Triangle> triangles;
  for (const Om::FaceHandle face : mesh.faces()) {
    glm::dvec3 corners[3];
    int count = 0;
    for (const Om::VertexHandle vertex : mesh.fv_range(face)) {
      const ProxyMesh::Point& p = mesh.point(vertex);
      corners[count++] = {p[0], p[1], p[2]};
    }
    triangles.push_back({corners[0], corners[1], corners[2]});
  }
  return triangles;
}

ProxyMesh mapped(const ProxyMesh& mesh, const glm::dmat4x3& map) {
  const bool mirrors = glm::determinant(glm::dmat3(map)) < 0;
  ProxyMesh out;
  for (const Om::VertexHandle vertex : mesh.vertices()) {
    const ProxyMesh::Point& p = mesh.point(vertex);
    out.add_vertex(pointOf(glm::vec3(map * glm::dvec4(p[0], p[1], p[2], 1))));
  }
  for (const Om::FaceHandle face : mesh.faces()) {
    std::vector<Om::VertexHandle> corners;
    for (const Om::VertexHandle vertex : mesh.fv_range(face)) corners.push_back(vertex);
    if (mirrors) std::swap(corners[1], corners[2]);  // the first stays
    out.add_face(corners);
  }
  return out;
}

std::string encodeMesh(const ProxyMesh& mesh, const std::string& extension) {
  const bool text = extension == ".obj" || extension == ".off";
  constexpr std::streamsize kDigitsOfFloat = 9;
  std::ostringstream stream;
  omlog().disable();  // reports that it writes
  if (!Om::IO::write_mesh(mesh, stream, extension, text ? Om::IO::Options::Default : Om::IO::Options::Binary,
                          kDigitsOfFloat))
    throw ToolError(Exit::kRuntime, "OpenMesh cannot write a mesh as " + extension);
  return std::move(stream).str();
}

}  // namespace kelp::dump

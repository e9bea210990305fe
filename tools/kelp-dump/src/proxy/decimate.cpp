// SPDX-License-Identifier: MIT
#include "proxy/decimate.h"

#include <algorithm>
#include <limits>
#include <queue>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/BaseDecimaterT.hh>

#include "kelp/common/error.h"
#include "proxy/covered.h"
#include "proxy/placed_quadrics.h"

namespace kelp::dump {
namespace {

namespace Om = OpenMesh;

struct Traits : Om::DefaultTraits {
  using Point = Om::Vec3d;
  using Normal = Om::Vec3d;
};
using Mesh = Om::TriMesh_ArrayKernelT<Traits>;

constexpr double kLeastCosine = 0;  // of the angle by which a collapse turns a triangle
constexpr std::uint32_t kNoFace = std::numeric_limits<std::uint32_t>::max();

glm::dvec3 toGlm(const Om::Vec3d& p) { return {p[0], p[1], p[2]}; }
Om::Vec3d toOm(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
std::size_t at(const Om::BaseHandle& handle) { return static_cast<std::size_t>(handle.idx()); }

// Which triangle each voxel's face belongs to: one that is near.
class Owners {
 public:
  Owners(const std::vector<std::uint32_t>& owner, std::size_t triangles)
      : next_(owner.size()), first_(triangles, kNoFace) {
    for (std::uint32_t i = 0; i < owner.size(); ++i) give(i, owner[i]);
  }
  void give(std::uint32_t face, std::size_t triangle) {
    next_[face] = first_[triangle];
    first_[triangle] = face;
  }
  void takeAll(std::size_t triangle, std::vector<std::uint32_t>& faces) const {
    for (std::uint32_t i = first_[triangle]; i != kNoFace; i = next_[i]) faces.push_back(i);
  }
  void clear(std::size_t triangle) { first_[triangle] = kNoFace; }

 private:
  std::vector<std::uint32_t> next_, first_;
};

// OpenMesh's decimater with a queue of its own: what a collapse costs is known at once, whether it may happen
// is only tested when it is its turn. That is most of the work. An edge belongs to the vertex of the lower
// index.
class Decimater : public Om::Decimater::BaseDecimaterT<Mesh> {
 public:
  Decimater(Mesh& mesh, const VoxelSurface& surface, const std::vector<VoxelFace>& faces,
            const SurfaceDistance& distance, double most)
      : BaseDecimaterT(mesh),
        mesh_(mesh),
        faces_(faces),
        owners_(surface.owner, mesh.n_faces()),
        distance_(distance),
        most_(most),
        chosen_(mesh.n_vertices()),
        tried_(mesh.n_edges()) {
    add(quadrics_);
    initialize();
  }

  void run() {
    // A collapse makes others possible, also some that are not beside it.
    do {
      sweep();
    } while (collapses_ > 0);
    // What is left is little, so that more places can be tried.
    places_ = kPlaces;
    sweep();
  }

 private:
  static constexpr int kBestPlaces = 4;  // that placeOf() knows
  static constexpr int kPlaces = 40;     // the others are random
  struct Choice {
    Om::HalfedgeHandle halfedge;
    Om::Vec3d place;
    std::uint32_t version = 0;
  };
  struct Waiting {
    float priority;
    int vertex;
    std::uint32_t version;
    bool operator<(const Waiting& other) const {
      return priority > other.priority || (priority == other.priority && vertex > other.vertex);
    }
  };

  void sweep() {
    collapses_ = 0;
    std::fill(tried_.begin(), tried_.end(), std::uint8_t{0});
    for (const Om::VertexHandle vertex : mesh_.vertices()) choose(vertex);
    std::vector<Om::VertexHandle> ring;
    while (!queue_.empty()) {
      const Waiting next = queue_.top();
      queue_.pop();
      const Om::VertexHandle vertex(next.vertex);
      const Choice choice = chosen_[at(vertex)];
      if (mesh_.status(vertex).deleted() || next.version != choice.version) continue;
      CollapseInfo collapse(mesh_, choice.halfedge);
      const bool legal = is_collapse_legal(collapse);
      if (!legal || !mayHappen(collapse, choice.place)) {
        std::uint8_t& tried = tried_[at(mesh_.edge_handle(choice.halfedge))];
        tried = legal ? static_cast<std::uint8_t>(tried + 1) : static_cast<std::uint8_t>(places_);
        choose(vertex);
        continue;
      }
      happen(collapse, choice.place);
      ring.assign(1, collapse.v1);
      for (const Om::VertexHandle other : mesh_.vv_range(collapse.v1)) ring.push_back(other);
      for (const Om::VertexHandle other : ring) {
        for (const Om::EdgeHandle edge : mesh_.ve_range(other)) tried_[at(edge)] = 0;
        choose(other);
      }
    }
  }

  // Where the vertex can be left, the best places first, then random ones around the edge.
  Om::Vec3d placeOf(const CollapseInfo& collapse, int number) {
    switch (number) {
      case 0:
        return module(quadrics_).best(collapse);
      case 1:
        return (collapse.p0 + collapse.p1) * 0.5;
      case 2:
        return collapse.p0;
      case 3:
        return collapse.p1;
      default: {
        const Om::Vec3d on_edge = collapse.p0 + (collapse.p1 - collapse.p0) * random();
        const Om::Vec3d towards{random() - 0.5, random() - 0.5, random() - 0.5};  // in this order
        return on_edge + towards * (2 * most_ * random());
      }
    }
  }

  // From 0 to 1, the same in every run.
  double random() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 32) / 4294967296.0;
  }

  // The cheapest collapse of a vertex' edges, of those that were not tried.
  void choose(Om::VertexHandle vertex) {
    if (mesh_.status(vertex).deleted()) return;
    Choice& choice = chosen_[at(vertex)];
    ++choice.version;
    float least = std::numeric_limits<float>::max();
    for (const Om::HalfedgeHandle out : mesh_.voh_range(vertex)) {
      const int tried = tried_[at(mesh_.edge_handle(out))];
      if (tried >= places_ || mesh_.to_vertex_handle(out).idx() < vertex.idx()) continue;
      const CollapseInfo collapse(mesh_, out);
      const Om::Vec3d place = placeOf(collapse, tried);
      module(quadrics_).place(place);
      const float priority = collapse_priority(collapse);
      if (!(priority < least)) continue;
      least = priority;
      choice.halfedge = out;
      choice.place = place;
    }
    if (least < std::numeric_limits<float>::max()) queue_.push({least, vertex.idx(), choice.version});
  }

  // Finds what the collapse changes: the triangles, as they will be, and the voxels' faces that belong to
  // them. False if a triangle turns too far, or if something would be too far away.
  bool mayHappen(const CollapseInfo& collapse, const Om::Vec3d& place) {
    changed_.clear(), triangles_.clear(), owned_.clear();
    bool turns = false;
    for (const Om::VertexHandle moved : {collapse.v0, collapse.v1}) {
      const Om::Vec3d before = mesh_.point(moved);
      mesh_.set_point(moved, place);
      for (const Om::FaceHandle face : mesh_.vf_range(moved)) {
        const bool goes = face == collapse.fl || face == collapse.fr;
        if (!goes || moved == collapse.v0) owners_.takeAll(at(face), owned_);
        if (goes) continue;
        turns = turns || !((mesh_.normal(face) | mesh_.calc_face_normal(face)) >= kLeastCosine);
        changed_.push_back(face);
        triangles_.push_back(triangleOf(face));
      }
      mesh_.set_point(moved, before);
    }
    return !turns && std::all_of(owned_.begin(), owned_.end(), [&](std::uint32_t face) {
      return covered(faces_[face], triangles_, most_);
    }) && std::all_of(triangles_.begin(), triangles_.end(), [&](const Triangle& triangle) {
      return distance_.within(triangle, most_);
    });
  }

  // Does what mayHappen() tested last.
  void happen(CollapseInfo& collapse, const Om::Vec3d& place) {
    preprocess_collapse(collapse);
    mesh_.collapse(collapse.v0v1);
    mesh_.set_point(collapse.v1, place);
    postprocess_collapse(collapse);
    for (const Om::FaceHandle face : {collapse.fl, collapse.fr}) owners_.clear(at(face));
    for (const Om::FaceHandle face : changed_) {
      mesh_.set_normal(face, mesh_.calc_face_normal(face));
      owners_.clear(at(face));
    }
    for (const std::uint32_t face : owned_) {
      const glm::dvec3 middle = faces_[face].middle();
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::max();
      for (std::size_t i = 0; i < triangles_.size(); ++i)
        if (const double apart = squaredDistance(middle, triangles_[i]); apart < least)
          least = apart, nearest = i;
      owners_.give(face, at(changed_[nearest]));
    }
    ++collapses_;
  }

  Triangle triangleOf(Om::FaceHandle face) const {
    Triangle triangle;
    auto vertex = mesh_.cfv_iter(face);
    triangle.a = toGlm(mesh_.point(*vertex));
    triangle.b = toGlm(mesh_.point(*++vertex));
    triangle.c = toGlm(mesh_.point(*++vertex));
    return triangle;
  }

  Mesh& mesh_;
  PlacedQuadrics<Mesh>::Handle quadrics_;
  const std::vector<VoxelFace>& faces_;
  Owners owners_;
  const SurfaceDistance& distance_;
  const double most_;
  std::vector<Choice> chosen_;       // of each vertex
  std::vector<std::uint8_t> tried_;  // of each edge: so many of its places
  std::priority_queue<Waiting> queue_;
  int places_ = kBestPlaces;  // that are tried
  std::uint64_t state_ = 1;   // of random()
  std::size_t collapses_ = 0;
  // Of mayHappen().
  std::vector<Om::FaceHandle> changed_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> owned_;
};

Mesh meshOf(const VoxelSurface& surface) {
  Mesh mesh;
  mesh.reserve(surface.place.size(), surface.triangles.size() * 3 / 2, surface.triangles.size());
  for (const glm::dvec3& place : surface.place) mesh.add_vertex(toOm(place));
  const auto vertex = [](std::uint32_t index) { return Om::VertexHandle(static_cast<int>(index)); };
  for (const auto& [a, b, c] : surface.triangles)
    if (!mesh.add_face(vertex(a), vertex(b), vertex(c)).is_valid())
      throw ToolError(Exit::kRuntime, "the surface of the voxels is not manifold: a fault of this program");
  mesh.request_face_normals();
  mesh.update_face_normals();
  return mesh;
}

ProxyMesh proxyOf(const Mesh& mesh) {
  ProxyMesh proxy;
  std::vector<std::uint32_t> number(mesh.n_vertices());
  for (const Om::VertexHandle vertex : mesh.vertices()) {  // leaves out what was deleted
    number[at(vertex)] = static_cast<std::uint32_t>(proxy.points.size());
    proxy.points.push_back(toGlm(mesh.point(vertex)));
  }
  for (const Om::FaceHandle face : mesh.faces()) {
    std::array<std::uint32_t, 3>& triangle = proxy.triangles.emplace_back();
    std::size_t corner = 0;
    for (const Om::VertexHandle vertex : mesh.fv_range(face)) triangle[corner++] = number[at(vertex)];
  }
  return proxy;
}

}  // namespace

ProxyMesh decimate(const VoxelSurface& surface, const std::vector<VoxelFace>& faces,
                   const SurfaceDistance& distance, double most) {
  Mesh mesh = meshOf(surface);
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  Decimater(mesh, surface, faces, distance, most).run();
  return proxyOf(mesh);
}

}  // namespace kelp::dump

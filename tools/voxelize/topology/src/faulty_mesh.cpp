// SPDX-License-Identifier: MIT
#include "faulty_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

#include "bucket_sort.h"

namespace kelp::bake {
namespace {

// Sides and corners of faces have the number 3 face + corner, as the file winds them: also of faces that are
// turned.
class FaultyMeshMaker {
 public:
  FaultyMeshMaker(Topology& mesh, std::vector<Edge> edges, FaultyMesh& made)
      : mesh_(mesh), edges_(std::move(edges)), made_(made) {}

  void make() {
    chooseFaces();
    if (made_.triangles.empty()) return;
    if (winds_amiss_) {
      findNeighbors();
      wind();
    }
    pairSides();
    edges_ = {};
    numberVertices();
    for (std::uint32_t face = 0; face < turned_.size(); ++face) {
      if (turned_[face]) mesh_.triangles[made_.triangles[face]].turn();
    }
    connectFaces();
    connectOpenEdges();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  const std::array<std::uint32_t, 3>& corners(std::uint32_t face) const {
    return mesh_.triangles[made_.triangles[face]].vertex;
  }
  bool runsUp(std::uint32_t side) const {
    const auto& v = corners(side / 3);
    return v[side % 3] < v[(side + 1) % 3];
  }
  // The corner at the edge's end of the lower number, and the other.
  std::uint32_t cornerOf(std::uint32_t side, bool low) const {
    return runsUp(side) == low ? side : side - side % 3 + (side + 1) % 3;
  }
  std::uint32_t sideOf(const Edge& edge) const { return 3 * face_of_[edge.triangle] + edge.side; }

  template <class Visit>
  void forEachFaultyEdge(const Visit& visit) const {
    forEachEdge(edges_, [&](std::size_t begin, std::size_t end) {
      if (face_of_[edges_[begin].triangle] != kNone) visit(begin, end);
    });
  }

  void chooseFaces() {
    std::vector<bool> faulty(mesh_.components.size(), false);
    forEachEdge(edges_, [&](std::size_t begin, std::size_t end) {
      const Edge& edge = edges_[begin];
      const bool alike = end - begin == 2 && edge.forward == edges_[begin + 1].forward;
      winds_amiss_ = winds_amiss_ || alike;
      if (end - begin != 2 || alike) faulty[mesh_.triangles[edge.triangle].component] = true;
    });
    face_of_.assign(mesh_.triangles.size(), kNone);
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      if (!faulty[mesh_.triangles[i].component]) continue;
      face_of_[i] = static_cast<std::uint32_t>(made_.triangles.size());
      made_.triangles.push_back(i);
    }
    turned_.assign(made_.triangles.size(), false);
  }

  void findNeighbors() {
    across_.assign(3 * made_.triangles.size(), kNone);
    forEachFaultyEdge([&](std::size_t begin, std::size_t end) {
      if (end - begin != 2) return;
      const std::uint32_t a = sideOf(edges_[begin]), b = sideOf(edges_[begin + 1]);
      across_[a] = b;
      across_[b] = a;
    });
  }

  void wind() {
    enum : std::uint8_t { kKeep, kTurn, kUnseen };
    std::vector<std::uint8_t> state(made_.triangles.size(), kUnseen);
    std::vector<std::uint32_t> patch;
    for (std::uint32_t seed = 0; seed < state.size(); ++seed) {
      if (state[seed] != kUnseen) continue;
      state[seed] = kKeep;
      patch.assign(1, seed);
      std::array<double, 2> area{};
      for (std::size_t at = 0; at < patch.size(); ++at) {
        const std::uint32_t face = patch[at];
        area[state[face]] += glm::length(mesh_.areaVector(mesh_.triangles[made_.triangles[face]]));
        for (std::uint32_t side = 3 * face; side < 3 * face + 3; ++side) {
          const std::uint32_t other = across_[side];
          if (other == kNone || state[other / 3] != kUnseen) continue;
          const bool alike = runsUp(side) != runsUp(other);
          state[other / 3] = alike == (state[face] == kKeep) ? kKeep : kTurn;
          patch.push_back(other / 3);
        }
      }
      const std::uint8_t wrong = area[kTurn] <= area[kKeep] ? kTurn : kKeep;
      for (const std::uint32_t face : patch) turned_[face] = state[face] == wrong;
    }
    across_ = {};
  }

  void pairSides() {
    half_edge_of_.resize(3 * made_.triangles.size());
    fans_ = DisjointSets(half_edge_of_.size());
    std::array<std::vector<std::uint32_t>, 2> sides;  // that run down, up
    forEachFaultyEdge([&](std::size_t begin, std::size_t end) {
      for (auto& those : sides) those.clear();
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t side = sideOf(edges_[i]);
        sides[runsUp(side) != turned_[side / 3]].push_back(side);
      }
      for (std::size_t i = 0; i < std::max(sides[0].size(), sides[1].size()); ++i, ++edge_count_) {
        for (std::uint32_t up = 0; up < 2; ++up) {
          if (i < sides[up].size()) half_edge_of_[sides[up][i]] = 2 * edge_count_ + up;
        }
        if (i >= sides[0].size() || i >= sides[1].size()) continue;
        for (const bool low : {true, false})
          fans_.join(cornerOf(sides[0][i], low), cornerOf(sides[1][i], low));
      }
      EdgeCounts& diagnosis = mesh_.components[mesh_.triangles[edges_[begin].triangle].component].diagnosis;
      diagnosis.open_edges += end - begin == 1;
      diagnosis.split_edges += end - begin > 2;
      diagnosis.cut_edges += end - begin == 2 && sides[0].size() != 1;
    });
  }

  void numberVertices() {
    std::vector<std::uint32_t> root_of;  // the first corner of each vertex
    vertex_of_.resize(half_edge_of_.size());
    for (std::uint32_t corner = 0; corner < vertex_of_.size(); ++corner) {
      const std::uint32_t root = fans_.find(corner);
      if (root == corner) {
        vertex_of_[corner] = static_cast<std::uint32_t>(made_.vertices.size());
        made_.vertices.push_back(corners(corner / 3)[corner % 3]);
        root_of.push_back(corner);
      }
      vertex_of_[corner] = vertex_of_[root];
    }
    fans_ = DisjointSets(0);
    using Place = std::array<std::uint32_t, 2>;  // vertex of the mesh, component
    const auto make = [&](const auto& take) {
      for (std::size_t i = 0; i < root_of.size(); ++i)
        take(made_.vertices[i],
             Place{made_.vertices[i], mesh_.triangles[made_.triangles[root_of[i] / 3]].component});
    };
    const std::vector<Place> places = sortedByVertex<Place>(mesh_.lattice.size(), 1, make, std::less<>());
    for (std::size_t i = 1; i < places.size(); ++i)
      mesh_.components[places[i][1]].diagnosis.split_vertices += places[i] == places[i - 1];
  }

  // The kernel's own calls: add_face() finds edges by their ends, so that it knows no two between the same
  // vertices, which a surface that touches itself along an edge has.
  void connectFaces() {
    HalfEdgeMesh& half_edges = made_.half_edges;
    half_edges.resize(made_.vertices.size(), edge_count_, made_.triangles.size());
    for (std::uint32_t face = 0; face < made_.triangles.size(); ++face) {
      const OpenMesh::FaceHandle handle = half_edges.face_handle(face);
      const std::array<std::uint32_t, 3> order =
          turned_[face] ? std::array<std::uint32_t, 3>{0, 2, 1} : std::array<std::uint32_t, 3>{0, 1, 2};
      std::array<OpenMesh::HalfedgeHandle, 3> around;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = order[k], to = order[(k + 1) % 3];
        around[k] = half_edges.halfedge_handle(half_edge_of_[3 * face + (turned_[face] ? to : from)]);
        half_edges.set_face_handle(around[k], handle);
        half_edges.set_vertex_handle(around[k], vertexAt(3 * face + to));
        half_edges.set_vertex_handle(half_edges.opposite_halfedge_handle(around[k]),
                                     vertexAt(3 * face + from));
        half_edges.set_halfedge_handle(vertexAt(3 * face + from), around[k]);
      }
      for (std::size_t k = 0; k < 3; ++k) half_edges.set_next_halfedge_handle(around[k], around[(k + 1) % 3]);
      half_edges.set_halfedge_handle(handle, around[0]);
    }
  }
  OpenMesh::VertexHandle vertexAt(std::uint32_t corner) const {
    return made_.half_edges.vertex_handle(vertex_of_[corner]);
  }

  // The next open half-edge is on the other side of the triangles around the vertex.
  void connectOpenEdges() {
    HalfEdgeMesh& half_edges = made_.half_edges;
    for (const OpenMesh::SmartHalfedgeHandle open : half_edges.halfedges()) {
      if (!open.is_boundary()) continue;
      OpenMesh::SmartHalfedgeHandle next = open.opp();
      while (!next.is_boundary()) next = next.prev().opp();
      half_edges.set_next_halfedge_handle(open, next);
      half_edges.set_halfedge_handle(open.to(), next);  // as OpenMesh wants it of vertices on a boundary
    }
  }

  Topology& mesh_;
  std::vector<Edge> edges_;
  FaultyMesh& made_;
  std::vector<std::uint32_t> face_of_;  // each triangle
  std::vector<std::uint32_t> across_;   // from each side
  std::vector<bool> turned_;            // each face
  bool winds_amiss_ = false;            // somewhere two triangles run along their edge in the same sense
  std::vector<std::uint32_t> half_edge_of_, vertex_of_;
  std::uint32_t edge_count_ = 0;
  DisjointSets fans_{0};  // of corners
};

using OpenMesh::SmartHalfedgeHandle;

class HoleFinder {
 public:
  HoleFinder(const Topology& mesh, const FaultyMesh& faulty)
      : mesh_(mesh),
        faulty_(faulty),
        place_(mesh.lattice.size(), kNowhere),
        leaving_(mesh.lattice.size(), kNowhere) {}

  std::vector<Hole> find() {
    std::vector<SmartHalfedgeHandle> open;
    for (const SmartHalfedgeHandle half_edge : faulty_.half_edges.halfedges()) {
      if (half_edge.is_boundary()) open.push_back(half_edge);
    }
    std::stable_sort(open.begin(), open.end(),
                     [&](const auto& a, const auto& b) { return componentOf(a) < componentOf(b); });
    for (std::size_t begin = 0; begin < open.size();) {
      std::size_t end = begin;
      while (end < open.size() && componentOf(open[end]) == componentOf(open[begin])) ++end;
      walk(std::span<const SmartHalfedgeHandle>(open).subspan(begin, end - begin));
      begin = end;
    }
    return std::move(holes_);
  }

 private:
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

  std::uint32_t nameOf(OpenMesh::SmartVertexHandle vertex) const {
    return faulty_.vertices[static_cast<std::size_t>(vertex.idx())];
  }
  std::uint32_t componentOf(SmartHalfedgeHandle open) const {
    const auto face = static_cast<std::size_t>(open.opp().face().idx());
    return mesh_.triangles[faulty_.triangles[face]].component;
  }

  // All open half-edges of a component. At each vertex as many arrive as leave, and are taken in their order.
  void walk(std::span<const SmartHalfedgeHandle> open) {
    std::vector<std::uint32_t> following(open.size(), kNowhere);  // the next that leaves the same vertex
    for (std::size_t i = open.size(); i-- > 0;)
      following[i] = std::exchange(leaving_[nameOf(open[i].from())], static_cast<std::uint32_t>(i));
    for (const SmartHalfedgeHandle first : open) {
      const std::uint32_t start = nameOf(first.to());
      std::uint32_t at = start;
      while (leaving_[start] != kNowhere || !path_.empty()) {
        const SmartHalfedgeHandle half_edge = open[leaving_[at]];
        leaving_[at] = following[leaving_[at]];
        place_[at] = static_cast<std::uint32_t>(path_.size());
        path_.push_back(half_edge);
        at = nameOf(half_edge.to());
        if (place_[at] != kNowhere) cutOff(place_[at]);
      }
    }
  }

  // The path from `first` on is a hole.
  void cutOff(std::uint32_t first) {
    Hole& hole = holes_.emplace_back();
    hole.component = componentOf(path_[first]);
    for (std::size_t i = first; i < path_.size(); ++i) {
      hole.corners.push_back(nameOf(path_[i].from()));
      place_[hole.corners.back()] = kNowhere;
    }
    path_.erase(path_.begin() + first, path_.end());
  }

  const Topology& mesh_;
  const FaultyMesh& faulty_;
  std::vector<std::uint32_t> place_;    // on the path, of each vertex of the mesh
  std::vector<std::uint32_t> leaving_;  // the first open half-edge from there that is not taken yet
  std::vector<SmartHalfedgeHandle> path_;
  std::vector<Hole> holes_;
};

}  // namespace

FaultyMesh makeFaultyMesh(Topology& mesh, std::vector<Edge> edges) {
  FaultyMesh made;  // filled in place: OpenMesh copies a mesh that is moved
  FaultyMeshMaker(mesh, std::move(edges), made).make();
  return made;
}

std::vector<Hole> findHoles(Topology& mesh, const FaultyMesh& faulty) {
  std::vector<Hole> holes = HoleFinder(mesh, faulty).find();
  for (const Hole& hole : holes) ++mesh.components[hole.component].diagnosis.holes;
  return holes;
}

std::vector<SolidTriangle> makeFans(Topology& mesh, const std::vector<Hole>& holes) {
  std::vector<SolidTriangle> fans;
  for (const Hole& hole : holes) {
    glm::dvec3 moment(0);
    double length = 0;
    const auto apex = static_cast<std::uint32_t>(mesh.lattice.size());
    for (std::size_t i = 0; i < hole.corners.size(); ++i) {
      const std::uint32_t corner = hole.corners[i], next = hole.corners[(i + 1) % hole.corners.size()];
      const glm::dvec3 a(mesh.lattice[corner]), b(mesh.lattice[next]);
      moment += (a + b) * 0.5 * glm::length(b - a);
      length += glm::length(b - a);
      SolidTriangle& triangle = fans.emplace_back();
      triangle.vertex = {corner, next, apex};
      triangle.source = kCap;
      triangle.component = hole.component;
    }
    const glm::dvec3 p = moment / length;
    mesh.lattice.emplace_back(std::llround(p.x), std::llround(p.y), std::llround(p.z));
  }
  return fans;
}

}  // namespace kelp::bake

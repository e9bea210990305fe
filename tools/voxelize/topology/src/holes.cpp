// SPDX-License-Identifier: MIT
#include "holes.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace kelp::bake {
namespace {

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

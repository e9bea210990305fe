// SPDX-License-Identifier: MIT
#include "holes.h"

#include <algorithm>

namespace kelp::bake {
namespace {

using OpenMesh::SmartHalfedgeHandle;

class HoleFinder {
 public:
  HoleFinder(const Topology& mesh, const FaultyMesh& faulty)
      : mesh_(mesh), faulty_(faulty), place_(mesh.lattice.size(), kNowhere) {}

  std::vector<Hole> find() {
    std::vector<SmartHalfedgeHandle> open;
    for (const SmartHalfedgeHandle half_edge : faulty_.half_edges.halfedges()) {
      if (half_edge.is_boundary()) open.push_back(half_edge);
    }
    std::stable_sort(open.begin(), open.end(),
                     [&](const auto& a, const auto& b) { return componentOf(a) < componentOf(b); });
    std::vector<bool> seen(faulty_.half_edges.n_halfedges(), false);
    for (const SmartHalfedgeHandle first : open) {
      if (seen[static_cast<std::size_t>(first.idx())]) continue;
      SmartHalfedgeHandle at = first;
      do {
        at = at.next();
        seen[static_cast<std::size_t>(at.idx())] = true;
        std::uint32_t& place = place_[from(at)];
        if (place != kNowhere) cutOff(place);
        place = static_cast<std::uint32_t>(path_.size());
        path_.push_back(at);
      } while (at != first);
      cutOff(0);
    }
    return std::move(holes_);
  }

 private:
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

  std::uint32_t from(SmartHalfedgeHandle half_edge) const {
    return faulty_.vertices[static_cast<std::size_t>(half_edge.from().idx())];
  }
  std::uint32_t componentOf(SmartHalfedgeHandle open) const {
    const auto face = static_cast<std::size_t>(open.opp().face().idx());
    return mesh_.triangles[faulty_.triangles[face]].component;
  }

  // What has been walked from `first` on is a hole.
  void cutOff(std::uint32_t first) {
    Hole& hole = holes_.emplace_back();
    hole.component = componentOf(path_[first]);
    for (std::size_t i = first; i < path_.size(); ++i) {
      hole.corners.push_back(from(path_[i]));
      glm::dvec3 normal(0);
      for (const OpenMesh::SmartFaceHandle face : path_[i].from().faces())
        normal += mesh_.areaVector(mesh_.triangles[faulty_.triangles[static_cast<std::size_t>(face.idx())]]);
      hole.normals.push_back(normal);
      place_[hole.corners.back()] = kNowhere;
    }
    path_.erase(path_.begin() + first, path_.end());
  }

  const Topology& mesh_;
  const FaultyMesh& faulty_;
  std::vector<std::uint32_t> place_;  // on the path, of each vertex of the mesh
  std::vector<SmartHalfedgeHandle> path_;
  std::vector<Hole> holes_;
};

}  // namespace

void Hole::turn() {
  std::reverse(corners.begin() + 1, corners.end());
  std::reverse(normals.begin() + 1, normals.end());
  for (glm::dvec3& normal : normals) normal = -normal;
}

std::vector<Hole> findHoles(Topology& mesh, const FaultyMesh& faulty) {
  std::vector<Hole> holes = HoleFinder(mesh, faulty).find();
  for (const Hole& hole : holes) ++mesh.components[hole.component].diagnosis.holes;
  return holes;
}

}  // namespace kelp::bake

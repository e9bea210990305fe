// SPDX-License-Identifier: MIT
#include "kelp/voxelize/topology/mesh_counts.h"

#include <algorithm>
#include <array>
#include <functional>
#include <unordered_map>

#include "bucket_sort.h"

namespace kelp::bake {
namespace {

// Sets of vertices that boundary edges join.
class Rims {
 public:
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  std::uint64_t count() const { return count_; }

 private:
  std::uint32_t find(std::uint32_t vertex) {
    count_ += parent_.try_emplace(vertex, vertex).second;
    for (std::uint32_t up = parent_[vertex]; up != vertex; up = parent_[vertex])
      vertex = parent_[vertex] = parent_[up];
    return vertex;
  }
  std::unordered_map<std::uint32_t, std::uint32_t> parent_;
  std::uint64_t count_ = 0;
};

}  // namespace

MeshCounts countMesh(const TriangleSoup& soup, int threads) {
  MeshCounts counts;
  counts.vertices = soup.positions.size();
  counts.triangles = soup.triangles.size();
  counts.dropped = soup.dropped;
  using Ends = std::array<std::uint32_t, 2>;
  const auto make = [&](const auto& take) {
    for (const TriangleSoup::Triangle& triangle : soup.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(triangle.vertex[i], triangle.vertex[(i + 1) % 3]);
        take(low, Ends{low, high});
      }
    }
  };
  const std::vector<Ends> edges = sortedByVertex<Ends>(soup.positions.size(), threads, make, std::less<>());
  Rims rims;
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end] == edges[begin]) ++end;
    if (end - begin > 2) ++counts.non_manifold_edges;
    if (end - begin == 1) {
      ++counts.boundary_edges;
      rims.join(edges[begin][0], edges[begin][1]);
    }
    begin = end;
  }
  counts.boundaries = rims.count();
  return counts;
}

FillCounts countFill(const Topology& mesh, std::uint64_t triangles) {
  FillCounts counts;
  counts.components = mesh.components.size();
  for (const Component& component : mesh.components) {
    counts.closed += component.closed;
    counts.walls += component.wall;
    counts.sheets += !component.solid && !component.wall;
    counts.capped += component.solid && !component.closed;
    counts.diagnosis += component.diagnosis;
  }
  counts.cap_triangles = mesh.caps;
  counts.doubled = triangles - (mesh.triangles.size() - mesh.caps);
  counts.turned = static_cast<std::uint64_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                    [](const SolidTriangle& t) { return t.source != kCap && t.swapped; }));
  return counts;
}

}  // namespace kelp::bake

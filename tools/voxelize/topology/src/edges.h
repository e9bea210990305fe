// SPDX-License-Identifier: MIT
// The edges of a triangle soup, and what they join.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

#include "bucket_sort.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The smaller index becomes the root, so that roots do not depend on the order of calls.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// One side of a triangle, from its corner of that number to the next. `forward`: that is from low to high.
// Walls share edges with walls only.
struct Edge {
  std::uint32_t low = 0, high = 0, triangle = 0;
  std::uint8_t side = 0;
  bool forward = false;
  bool wall = false;

  auto place() const { return std::tie(low, high, wall); }
};

// Sorted by place, then by triangle.
inline std::vector<Edge> sortedEdges(const Topology& mesh, bool separate_walls, int threads = 1) {
  const auto make = [&](const auto& take) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::uint8_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.triangles[i].vertex[k];
        const std::uint32_t b = mesh.triangles[i].vertex[(k + 1) % 3];
        const std::uint32_t low = std::min(a, b);
        take(low, Edge{low, std::max(a, b), i, k, a < b, separate_walls && mesh.triangles[i].wall});
      }
    }
  };
  return sortedByVertex<Edge>(mesh.lattice.size(), threads, make, [](const Edge& x, const Edge& y) {
    return std::tie(x.high, x.wall, x.triangle, x.side) < std::tie(y.high, y.wall, y.triangle, y.side);
  });
}

// Calls visit(begin, end) for each run of equal edges.
template <class Visit>
void forEachEdge(const std::vector<Edge>& edges, const Visit& visit) {
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].place() == edges[begin].place()) ++end;
    visit(begin, end);
    begin = end;
  }
}

}  // namespace kelp::bake

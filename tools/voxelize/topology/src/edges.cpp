// SPDX-License-Identifier: MIT
#include "edges.h"

#include "bucket_sort.h"

namespace kelp::bake {

std::vector<Edge> sortedEdges(const Topology& mesh, bool separate_walls, int threads) {
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

}  // namespace kelp::bake

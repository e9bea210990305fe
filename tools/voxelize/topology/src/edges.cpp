// SPDX-License-Identifier: MIT
#include "edges.h"

namespace kelp::bake {

std::vector<Edge> sortedEdges(const Topology& mesh, bool separate_walls) {
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i].vertex[k];
      const std::uint32_t b = mesh.triangles[i].vertex[(k + 1) % 3];
      edges.push_back(
          {std::min(a, b), std::max(a, b), i, k, a < b, separate_walls && mesh.triangles[i].wall});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.low, x.high, x.wall, x.triangle, x.side) <
           std::tie(y.low, y.high, y.wall, y.triangle, y.side);
  });
  return edges;
}

}  // namespace kelp::bake

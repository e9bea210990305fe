// SPDX-License-Identifier: MIT
// Closing the cracks that compressors leave: Draco rounds every primitive on a grid of its own, so what was one border becomes two, and a body
// of two materials would no longer be closed.
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "import_soup.h"

namespace kelp::bake {
namespace {

// The vertices of edges that one triangle alone has, ascending.
std::vector<std::uint32_t> openVertices(const TriangleSoup& soup) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * soup.triangles.size());
  for (const TriangleSoup::Triangle& triangle : soup.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangle.vertex[i], triangle.vertex[(i + 1) % 3]);
      edges.push_back(std::uint64_t{low} << 32 | high);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if (next - i > 1) continue;
    open.push_back(static_cast<std::uint32_t>(edges[i] >> 32));
    open.push_back(static_cast<std::uint32_t>(edges[i] & 0xffffffffu));
  }
  std::sort(open.begin(), open.end());
  open.erase(std::unique(open.begin(), open.end()), open.end());
  return open;
}

// Points in cells as wide as the reach: what is near lies in a neighbouring cell.
class NearbyPoints {
 public:
  NearbyPoints(const std::vector<glm::vec3>& positions, float reach) : positions_(positions), reach_(reach) {}

  // The nearest point that was kept, within reach; else keeps this one and answers it.
  std::uint32_t nearest(std::uint32_t point) {
    const glm::dvec3 at(positions_[point]);
    const glm::i64vec3 cell(glm::floor(at / static_cast<double>(reach_)));
    std::uint32_t found = point;
    double best = static_cast<double>(reach_);
    for (int i = 0; i < 27; ++i) {
      const auto entry = cells_.find(hash(cell + glm::i64vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (entry == cells_.end()) continue;
      for (std::uint32_t other : entry->second) {
        const double distance = glm::length(glm::dvec3(positions_[other]) - at);
        if (distance > best) continue;
        best = distance;
        found = other;
      }
    }
    if (found == point) cells_[hash(cell)].push_back(point);
    return found;
  }

 private:
  // Cells that share a number only cost time: distances decide.
  static std::uint64_t hash(const glm::i64vec3& cell) {
    std::uint64_t value = 0;
    for (int c = 0; c < 3; ++c) value = (value ^ static_cast<std::uint64_t>(cell[c])) * 0x9e3779b97f4a7c15u;
    return value ^ value >> 31;
  }

  const std::vector<glm::vec3>& positions_;
  float reach_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

void closeSeams(TriangleSoup& soup, float reach) {
  std::vector<std::uint32_t> moved(soup.positions.size());
  for (std::uint32_t i = 0; i < moved.size(); ++i) moved[i] = i;
  NearbyPoints points(soup.positions, reach);
  for (std::uint32_t vertex : openVertices(soup)) moved[vertex] = points.nearest(vertex);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    TriangleSoup::Triangle triangle = soup.triangles[t];
    for (std::uint32_t& vertex : triangle.vertex) vertex = moved[vertex];
    if (triangle.vertex[0] == triangle.vertex[1] || triangle.vertex[1] == triangle.vertex[2] || triangle.vertex[2] == triangle.vertex[0]) continue;
    soup.triangles[kept] = triangle;
    if (!soup.uvs.empty()) soup.uvs[kept] = soup.uvs[t];
    if (!soup.colors.empty()) soup.colors[kept] = soup.colors[t];
    ++kept;
  }
  soup.triangles.resize(kept);
  if (!soup.uvs.empty()) soup.uvs.resize(kept);
  if (!soup.colors.empty()) soup.colors.resize(kept);
}

}  // namespace kelp::bake

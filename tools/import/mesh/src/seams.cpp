// SPDX-License-Identifier: MIT
// Closes the cracks that compressors leave. Draco rounds every primitive on a grid of its own, so a common
// border becomes two, and a body of two materials would no longer be closed.
#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "kelp/import/core/source_model.h"
#include "kelp/import/mesh/soup.h"

namespace kelp::bake {
namespace {

// The vertices of edges with only one triangle, ascending.
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

// Points in cells as wide as the longest reach: near points are in the same or a neighboring cell.
class Seams {
 public:
  Seams(const std::vector<glm::vec3>& positions, const std::vector<std::uint32_t>& piece,
        const std::vector<float>& steps)
      : positions_(positions),
        piece_(piece),
        steps_(steps),
        cell_(reachOf(*std::max_element(steps.begin(), steps.end()),
                      *std::max_element(steps.begin(), steps.end()))) {}

  // Returns the nearest kept point that can be the same point; if there is none, keeps this one and returns
  // it. Points come piece by piece.
  std::uint32_t join(std::uint32_t point) {
    const glm::dvec3 at(positions_[point]);
    const glm::dvec3 cell = glm::floor(at / cell_);
    Kept* found = nullptr;
    double best = cell_;
    for (int i = 0; i < 27; ++i) {
      const auto entry = cells_.find(hash(cell + glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (entry == cells_.end()) continue;
      for (Kept& other : entry->second) {
        const double distance = glm::length(glm::dvec3(positions_[other.vertex]) - at);
        if (distance > best || distance > reachOf(steps_[piece_[other.vertex]], steps_[piece_[point]]))
          continue;
        // Two points of one piece stay two, even if both are near a third.
        if (other.last_piece == piece_[point]) continue;
        best = distance;
        found = &other;
      }
    }
    if (found) {
      found->last_piece = piece_[point];
      return found->vertex;
    }
    std::vector<Kept>& here = cells_[hash(cell)];
    if (here.size() < kMostInCell) here.push_back({point, piece_[point]});
    return point;
  }

 private:
  // A coarse piece among fine ones may have thousands of their points in a cell: this bound keeps the work
  // linear.
  static constexpr std::size_t kMostInCell = 64;

  struct Kept {
    std::uint32_t vertex;
    std::uint32_t last_piece;  // that has a vertex here
  };

  // Both points are at most half a step off along every axis.
  static double reachOf(float a, float b) {
    return 1.01 * std::sqrt(3.0) * 0.5 * (static_cast<double>(a) + static_cast<double>(b));
  }

  // Cells that share a number only cost time, because distances decide. Far from the origin and with a fine
  // step, cells have more digits than an integer; there neighbors may share a number, because floats cannot
  // be that near to each other.
  static std::uint64_t hash(const glm::dvec3& cell) {
    std::uint64_t value = 0;
    // so that -0 and 0 are the same
    for (int c = 0; c < 3; ++c)
      value = (value ^ std::bit_cast<std::uint64_t>(cell[c] + 0.0)) * 0x9e3779b97f4a7c15u;
    return value ^ value >> 31;
  }

  const std::vector<glm::vec3>& positions_;
  const std::vector<std::uint32_t>& piece_;
  const std::vector<float>& steps_;
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<Kept>> cells_;
};

}  // namespace

void closeSeams(TriangleSoup& soup, const std::vector<std::uint32_t>& piece,
                const std::vector<float>& steps) {
  std::vector<std::uint32_t> moved(soup.positions.size());
  for (std::uint32_t i = 0; i < moved.size(); ++i) moved[i] = i;
  Seams seams(soup.positions, piece, steps);
  for (std::uint32_t vertex : openVertices(soup)) moved[vertex] = seams.join(vertex);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    TriangleSoup::Triangle triangle = soup.triangles[t];
    for (std::uint32_t& vertex : triangle.vertex) vertex = moved[vertex];
    if (triangle.vertex[0] == triangle.vertex[1] || triangle.vertex[1] == triangle.vertex[2] ||
        triangle.vertex[2] == triangle.vertex[0])
      continue;
    soup.triangles[kept] = triangle;
    if (!soup.uvs.empty()) soup.uvs[kept] = soup.uvs[t];
    for (auto& uvs : soup.more_uvs)
      if (!uvs.empty()) uvs[kept] = uvs[t];
    if (!soup.colors.empty()) soup.colors[kept] = soup.colors[t];
    if (!soup.skinned.empty()) soup.skinned[kept] = soup.skinned[t];
    ++kept;
  }
  soup.triangles.resize(kept);
  if (!soup.uvs.empty()) soup.uvs.resize(kept);
  for (auto& uvs : soup.more_uvs)
    if (!uvs.empty()) uvs.resize(kept);
  if (!soup.colors.empty()) soup.colors.resize(kept);
  if (!soup.skinned.empty()) soup.skinned.resize(kept);
}

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// A mesh with as many triangles as a scan has, made of a smaller one.
#include <array>
#include <fstream>
#include <map>
#include <utility>

#include "bench_bake_peers.h"

namespace kelp::bench {
namespace {

using Face = std::array<std::uint32_t, 3>;

// Four of each.
void divideSides(std::vector<glm::vec3>& points, std::vector<Face>& faces) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
    if (fresh) points.push_back(0.5f * (points[a] + points[b]));
    return at->second;
  };
  std::vector<Face> divided;
  for (const auto& [a, b, c] : faces) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Face& face : {Face{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      divided.push_back(face);
  }
  faces = std::move(divided);
}

// Three of each, of as many as are needed, spread evenly.
void divideSome(std::size_t triangles, std::vector<glm::vec3>& points, std::vector<Face>& faces) {
  const std::size_t count = faces.size(), chosen = (triangles - count) / 2;
  for (std::size_t i = 0; i < chosen; ++i) {
    const std::size_t at = i * count / chosen;
    const auto [a, b, c] = faces[at];
    const std::uint32_t center = static_cast<std::uint32_t>(points.size());
    points.push_back((points[a] + points[b] + points[c]) / 3.0f);
    faces[at] = {a, b, center};
    faces.push_back({b, c, center});
    faces.push_back({c, a, center});
  }
}

}  // namespace

void writeDivided(const bake::TriangleSoup& soup, std::size_t triangles, const std::filesystem::path& path) {
  std::vector<glm::vec3> points = soup.positions;
  std::vector<Face> faces;
  for (const auto& triangle : soup.triangles) faces.push_back(triangle.vertex);
  while (faces.size() * 4 <= triangles) divideSides(points, faces);
  divideSome(triangles, points, faces);
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << faces.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  file.write(reinterpret_cast<const char*>(points.data()),
             static_cast<std::streamsize>(points.size() * sizeof points[0]));
  for (const Face& face : faces) {
    file.put(3);
    file.write(reinterpret_cast<const char*>(face.data()), sizeof face);
  }
}

}  // namespace kelp::bench

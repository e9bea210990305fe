// SPDX-License-Identifier: MIT
// The promises of a proxy, by counts and distances of the tests' own.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "extract_packs.h"

namespace kelp::test {

struct Mesh {
  std::vector<glm::dvec3> points;
  std::vector<std::array<int, 3>> triangles;
};

inline Mesh readObj(const std::string& path) {
  Mesh mesh;
  std::istringstream lines(readWhole(path));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      glm::dvec3& p = mesh.points.emplace_back();
      words >> p.x >> p.y >> p.z;
    } else if (word == "f") {
      for (int& corner : mesh.triangles.emplace_back()) {
        words >> word;
        corner = std::stoi(word) - 1;
      }
    }
  }
  return mesh;
}

// Every directed edge once, and its opposite once; the triangles of a vertex are one fan; every point is
// used, and no two are in one place. Returns the volume, which is positive if triangles face outward.
inline double expectClosedManifold(const Mesh& mesh) {
  std::set<std::pair<int, int>> edges;
  std::vector<std::map<int, int>> next(mesh.points.size());  // around a vertex
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3];
      EXPECT_TRUE(a >= 0 && a < static_cast<int>(mesh.points.size())) << a;
      EXPECT_TRUE(edges.emplace(a, b).second) << "an edge twice in one direction: " << a << " " << b;
      next.at(static_cast<std::size_t>(a))[b] = c;
    }
    const auto p = [&](std::size_t i) { return mesh.points.at(static_cast<std::size_t>(t[i])); };
    volume += glm::dot(p(0), glm::cross(p(1), p(2))) / 6;
  }
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a})) << "an open edge: " << a << " " << b;
  for (const std::map<int, int>& fan : next) {
    EXPECT_GE(fan.size(), 3u);
    std::size_t steps = 0;
    int at = fan.empty() ? 0 : fan.begin()->first;
    do {
      const auto step = fan.find(at);
      if (step == fan.end()) break;
      at = step->second;
      ++steps;
    } while (at != fan.begin()->first && steps <= fan.size());
    EXPECT_EQ(steps, fan.size()) << "a vertex with several fans";
  }
  std::set<std::array<double, 3>> places;
  for (const glm::dvec3& p : mesh.points)
    EXPECT_TRUE(places.insert({p.x, p.y, p.z}).second) << "two vertices in one place";
  return volume;
}

// The squared distance from a point to a triangle, by the regions of its corners, edges and inside: minimized
// over the plane's coordinates and over each edge.
inline double squaredTo(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto edge = [&](const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 d = to - from;
    const double t = std::clamp(glm::dot(p - from, d) / std::max(glm::dot(d, d), 1e-300), 0.0, 1.0);
    return glm::dot(p - from - t * d, p - from - t * d);
  };
  double least = std::min({edge(a, b), edge(b, c), edge(c, a)});
  const glm::dvec3 u = b - a, v = c - a, w = p - a;
  const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), det = uu * vv - uv * uv;
  if (det > 0) {
    const double s = (vv * glm::dot(w, u) - uv * glm::dot(w, v)) / det;
    const double t = (uu * glm::dot(w, v) - uv * glm::dot(w, u)) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      const glm::dvec3 apart = w - s * u - t * v;
      least = std::min(least, glm::dot(apart, apart));
    }
  }
  return least;
}

// Points of a triangle, at most `step` apart.
template <class F>
void sample(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double step, F&& f) {
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const int n = std::max(1, static_cast<int>(std::ceil(longest / step)));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) f(a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n));
}

// Faces of voxels as pairs of triangles, by looking at every voxel and its six neighbors.
inline std::vector<std::array<glm::dvec3, 3>> voxelTriangles(const KnownPart& part) {
  std::vector<std::array<glm::dvec3, 3>> triangles;
  part.eachVoxel(0, [&](const glm::ivec3& v) {
    if (!part.solid(v)) return;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        glm::ivec3 beside = v;
        beside[axis] += side ? 1 : -1;
        if (part.solid(beside)) continue;
        glm::dvec3 low(v), u(0), w(0);
        low[axis] += side;
        u[(axis + 1) % 3] = 1;
        w[(axis + 2) % 3] = 1;
        triangles.push_back({low, low + u, low + u + w});
        triangles.push_back({low, low + u + w, low + w});
      }
  });
  return triangles;
}

// The largest distances from samples of one to all triangles of the other: from the mesh, and to it. `mesh`
// is in voxels.
inline std::pair<double, double> bruteDistances(const Mesh& mesh, const KnownPart& part, double step) {
  const std::vector<std::array<glm::dvec3, 3>> voxels = voxelTriangles(part);
  std::vector<std::array<glm::dvec3, 3>> own;
  for (const auto& t : mesh.triangles)
    own.push_back({mesh.points[static_cast<std::size_t>(t[0])], mesh.points[static_cast<std::size_t>(t[1])],
                   mesh.points[static_cast<std::size_t>(t[2])]});
  const auto farthest = [&](const auto& from, const auto& to) {
    std::vector<std::pair<glm::dvec3, double>>
        around;  // the sphere around each; what is far need not be tried
    for (const auto& t : to) {
      const glm::dvec3 middle = (t[0] + t[1] + t[2]) / 3.0;
      around.emplace_back(middle, std::max({glm::distance(middle, t[0]), glm::distance(middle, t[1]),
                                            glm::distance(middle, t[2])}));
    }
    double most = 0;
    std::size_t nearest = 0;  // of the last sample
    for (const auto& t : from)
      sample(t[0], t[1], t[2], step, [&](const glm::dvec3& p) {
        double least = squaredTo(p, to[nearest][0], to[nearest][1], to[nearest][2]);
        for (std::size_t i = 0; i < to.size() && least > most; ++i) {
          const double reach = std::sqrt(least) + around[i].second;
          const glm::dvec3 apart = p - around[i].first;
          if (glm::dot(apart, apart) >= reach * reach) continue;
          const double squared = squaredTo(p, to[i][0], to[i][1], to[i][2]);
          if (squared < least) least = squared, nearest = i;
        }
        most = std::max(most, least);
      });
    return std::sqrt(most);
  };
  return {farthest(own, voxels), farthest(voxels, own)};
}

// The mesh in the voxels of a part.
inline Mesh inVoxels(Mesh mesh, const glm::mat4x3& to_object) {
  const glm::dmat4 back = glm::inverse(glm::dmat4(glm::dmat4x3(to_object)));
  for (glm::dvec3& p : mesh.points) p = glm::dvec3(back * glm::dvec4(p, 1));
  return mesh;
}

}  // namespace kelp::test

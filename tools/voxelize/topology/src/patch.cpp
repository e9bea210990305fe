// SPDX-License-Identifier: MIT
#include "patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace kelp::bake {
namespace {

using Corners = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = 0xffffffffu;

std::vector<Corners> triangulate(std::span<const glm::dvec3> p) {
  const std::size_t n = p.size();
  // least[i n + k]: the area of the best triangulation of the corners i .. k; apex: the corner that its
  // triangle at the edge k, i has.
  std::vector<double> least(n * n, 0.0);
  std::vector<std::uint32_t> apex(n * n, kNone);
  for (std::size_t reach = 2; reach < n; ++reach) {
    for (std::size_t i = 0; i + reach < n; ++i) {
      const std::size_t k = i + reach;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t j = i + 1; j < k; ++j) {
        const double area =
            least[i * n + j] + least[j * n + k] + 0.5 * glm::length(glm::cross(p[j] - p[i], p[k] - p[i]));
        if (area < best) {
          best = area;
          apex[i * n + k] = static_cast<std::uint32_t>(j);
        }
      }
      least[i * n + k] = best;
    }
  }
  std::vector<Corners> triangles;
  std::vector<std::array<std::uint32_t, 2>> spans{{0, static_cast<std::uint32_t>(n - 1)}};
  while (!spans.empty()) {
    const auto [i, k] = spans.back();
    spans.pop_back();
    if (k - i < 2) continue;
    const std::uint32_t j = apex[i * n + k];
    triangles.push_back({i, j, k});
    spans.push_back({i, j});
    spans.push_back({j, k});
  }
  return triangles;
}

// Splits triangles and turns edges, with the neighbours at hand.
class Refiner {
 public:
  explicit Refiner(Patch& patch) : patch_(patch) {
    std::vector<std::array<std::uint32_t, 4>> sides;  // low, high, triangle, side
    for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t) {
      for (std::uint32_t s = 0; s < 3; ++s) {
        const std::uint32_t a = patch_.triangles[t][s], b = patch_.triangles[t][(s + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), t, s});
      }
    }
    std::sort(sides.begin(), sides.end());
    beside_.assign(patch_.triangles.size(), {kNone, kNone, kNone});
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const auto& [low, high, t, s] = sides[i];
      const auto& [its_low, its_high, u, r] = sides[i + 1];
      if (low != its_low || high != its_high) continue;
      beside_[t][s] = u;
      beside_[u][r] = t;
    }
  }

  void refine(double length) {
    // A disc of n edges of this length has some n^2 / (4 pi) points within; whatever the polygon does, it
    // ends.
    const std::size_t most = patch_.rim + patch_.rim * patch_.rim / 4;
    turnAll();
    for (;;) {
      const std::size_t count = patch_.triangles.size();
      bool any = false;
      for (std::uint32_t t = 0; t < count && patch_.points.size() < most; ++t) any = split(t, length) || any;
      if (!any) return;
      turnAll();
    }
  }

 private:
  // At its centre, if that is far enough from all three corners.
  bool split(std::uint32_t t, double length) {
    const auto [a, b, c] = patch_.triangles[t];
    const glm::dvec3 centre = (patch_.points[a] + patch_.points[b] + patch_.points[c]) / 3.0;
    for (const std::uint32_t v : {a, b, c}) {
      if (glm::distance(patch_.points[v], centre) < length * 0.7071067811865476) return false;
    }
    const std::uint32_t v = static_cast<std::uint32_t>(patch_.points.size());
    patch_.points.push_back(centre);
    const std::uint32_t u = static_cast<std::uint32_t>(patch_.triangles.size()), w = u + 1;
    const auto [ab, bc, ca] = beside_[t];
    patch_.triangles[t] = {a, b, v};
    patch_.triangles.push_back({b, c, v});
    patch_.triangles.push_back({c, a, v});
    beside_[t] = {ab, u, w};
    beside_.push_back({bc, w, t});
    beside_.push_back({ca, t, u});
    replace(bc, t, u);
    replace(ca, t, w);
    return true;
  }

  void replace(std::uint32_t at, std::uint32_t from, std::uint32_t to) {
    if (at != kNone) *std::find(beside_[at].begin(), beside_[at].end(), from) = to;
  }

  // In the plane this ends with the Delaunay triangulation; in space it might go round in circles.
  void turnAll() {
    constexpr int kRounds = 16;
    bool any = true;
    for (int round = 0; round < kRounds && any; ++round) {
      any = false;
      for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t) {
        for (std::uint32_t s = 0; s < 3; ++s) any = turn(t, s) || any;
      }
    }
  }

  static double cotangent(const glm::dvec3& at, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::dot(b - at, c - at) / (glm::length(glm::cross(b - at, c - at)) + 1e-12);
  }

  // The edge a, b between the corners c and d becomes the edge c, d, if the angles there add up to more than
  // half a turn.
  bool turn(std::uint32_t t, std::uint32_t s) {
    const std::uint32_t u = beside_[t][s];
    if (u == kNone) return false;
    const std::uint32_t r =
        static_cast<std::uint32_t>(std::find(beside_[u].begin(), beside_[u].end(), t) - beside_[u].begin());
    const std::uint32_t a = patch_.triangles[t][s], b = patch_.triangles[t][(s + 1) % 3],
                        c = patch_.triangles[t][(s + 2) % 3], d = patch_.triangles[u][(r + 2) % 3];
    if (c == d || cotangent(patch_.points[c], patch_.points[a], patch_.points[b]) +
                          cotangent(patch_.points[d], patch_.points[a], patch_.points[b]) >
                      -1e-6)
      return false;
    const std::uint32_t bc = beside_[t][(s + 1) % 3], ca = beside_[t][(s + 2) % 3],
                        ad = beside_[u][(r + 1) % 3], db = beside_[u][(r + 2) % 3];
    if (bc == u || ca == u) return false;  // they share two edges
    patch_.triangles[t] = {c, a, d};
    patch_.triangles[u] = {d, b, c};
    beside_[t] = {ca, ad, u};
    beside_[u] = {db, bc, t};
    replace(ad, u, t);
    replace(bc, t, u);
    return true;
  }

  Patch& patch_;
  std::vector<Corners> beside_;  // the triangles across the sides 0 1, 1 2 and 2 0
};

}  // namespace

Patch spanPolygon(std::span<const glm::dvec3> polygon) {
  Patch patch;
  patch.rim = static_cast<std::uint32_t>(polygon.size());
  patch.points.assign(polygon.begin(), polygon.end());
  patch.triangles = triangulate(polygon);
  double length = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    length += glm::distance(polygon[i], polygon[(i + 1) % polygon.size()]);
  Refiner(patch).refine(length / static_cast<double>(polygon.size()));
  return patch;
}

}  // namespace kelp::bake

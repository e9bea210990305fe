// SPDX-License-Identifier: MIT
#include "import_soup.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace kelp::bake {
namespace {

// Twice the area of a, b, c: positive where they are wound counter-clockwise, exactly 0 where two of them are one point.
double cross2(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  if (a == b || b == c || c == a) return 0;
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

struct Ear {
  glm::dvec2 a, b, c;

  double area() const { return cross2(a, b, c); }
  // To the left of each side, positive: inside.
  std::array<double, 3> sides(const glm::dvec2& p) const { return {cross2(a, b, p), cross2(b, c, p), cross2(c, a, p)}; }

  // Whether a point that is none of the corners lies in the ear or on its rim.
  bool touches(const glm::dvec2& p) const {
    if (p == a || p == b || p == c) return false;
    const std::array<double, 3> left = sides(p);
    return left[0] >= 0 && left[1] >= 0 && left[2] >= 0;
  }

  // Whether more than the rounding of an edge runs through the inside.
  bool isCrossed(const glm::dvec2& p, const glm::dvec2& q) const {
    const std::array<double, 3> from = sides(p), to = sides(q);
    double begin = 0, end = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      if (from[i] <= 0 && to[i] <= 0) return false;
      const double crossing = from[i] / (from[i] - to[i]);
      if (from[i] < 0) begin = std::max(begin, crossing);
      if (to[i] < 0) end = std::min(end, crossing);
    }
    return end - begin > 1e-9;
  }
};

// How much is asked of an ear. A polygon with a hole reaches it by a bridge that it walks twice, so that its corners and edges touch each other:
// such a polygon may have no ear of the first kind, but as long as nothing crosses it has one of the first three.
enum class Ask { kNothingTouches, kNothingCrosses, kNoArea, kAnything };

bool isEar(const std::vector<glm::dvec2>& flat, const std::vector<std::uint32_t>& left, std::size_t at, Ask ask) {
  const std::size_t n = left.size();
  const Ear ear{flat[left[(at + n - 1) % n]], flat[left[at]], flat[left[(at + 1) % n]]};
  const double area = ear.area();
  if (ask == Ask::kAnything || (ask == Ask::kNoArea && area == 0)) return true;
  if (!(area > 0)) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 &p = flat[left[i]], &q = flat[left[(i + 1) % n]];
    if ((ask == Ask::kNothingTouches && ear.touches(p)) || ear.isCrossed(p, q)) return false;
  }
  return true;
}

// The polygon in its own plane, wound counter-clockwise: drops the axis in which Newell's normal is longest.
std::vector<glm::dvec2> flatten(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - glm::dvec3(corners[0]);
    const glm::dvec3 b = glm::dvec3(corners[(i + 1) % corners.size()]) - glm::dvec3(corners[0]);
    normal += glm::cross(a, b);
  }
  const glm::dvec3 size = glm::abs(normal);
  int drop = 2;
  if (size.x >= size.y && size.x >= size.z) drop = 0;
  else if (size.y >= size.z) drop = 1;
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const glm::vec3& corner : corners) {
    const glm::dvec3 p = glm::dvec3(corner) - glm::dvec3(corners[0]);
    flat.emplace_back(p[u], p[v]);
  }
  return flat;
}

// Attribute lists are empty or complete: the first triangle that has one fills in for those `before` it.
template <class T>
void append(std::vector<std::array<T, 3>>& list, const std::optional<std::array<T, 3>>& value, std::size_t before, const T& none) {
  if (!value && list.empty()) return;
  const std::array<T, 3> missing{none, none, none};
  list.resize(before, missing);
  list.push_back(value.value_or(missing));
}

}  // namespace

float srgbToLinear(float value) { return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f); }

std::size_t SoupBuilder::Hash::operator()(const std::array<std::uint32_t, 3>& bits) const {
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (std::uint32_t word : bits) {
    hash = (hash ^ word) * 0xff51afd7ed558ccdu;
    hash ^= hash >> 32;
  }
  return static_cast<std::size_t>(hash);
}

std::uint32_t SoupBuilder::vertex(glm::vec3 position) {
  position += 0.0f;  // -0 and +0 are one position
  const std::array<std::uint32_t, 3> bits{std::bit_cast<std::uint32_t>(position.x), std::bit_cast<std::uint32_t>(position.y),
                                          std::bit_cast<std::uint32_t>(position.z)};
  const auto [entry, fresh] = index_.try_emplace(bits, static_cast<std::uint32_t>(soup_.positions.size()));
  if (fresh) {
    soup_.positions.push_back(position);
    piece_.push_back(static_cast<std::uint32_t>(steps_.size() - 1));
  }
  return entry->second;
}

bool SoupBuilder::add(const Triangle& triangle) {
  if (soup_.triangles.size() >= kMaxTriangles) return false;
  for (const glm::vec3& p : triangle.position) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      ++non_finite_;
      return true;
    }
  }
  if (triangle.position[0] == triangle.position[1] || triangle.position[1] == triangle.position[2] || triangle.position[2] == triangle.position[0]) {
    ++degenerate_;
    return true;
  }
  TriangleSoup::Triangle entry;
  for (std::size_t i = 0; i < 3; ++i) entry.vertex[i] = vertex(triangle.position[i]);
  entry.material = triangle.material;
  append(soup_.uvs, triangle.uv, soup_.triangles.size(), glm::vec2(0));
  for (std::size_t i = 0; i < soup_.more_uvs.size(); ++i) append(soup_.more_uvs[i], triangle.more_uv[i], soup_.triangles.size(), glm::vec2(0));
  append(soup_.colors, triangle.color, soup_.triangles.size(), glm::vec4(1));
  soup_.triangles.push_back(entry);
  return true;
}

void SoupBuilder::roundedTo(float step) {
  steps_.push_back(step > 0 && std::isfinite(step) ? step : 0.0f);
}

TriangleSoup SoupBuilder::take() {
  index_.clear();
  soup_.dropped = non_finite_ + degenerate_;
  if (*std::max_element(steps_.begin(), steps_.end()) > 0) closeSeams(soup_, piece_, steps_);
  return std::move(soup_);
}

std::vector<std::array<std::uint32_t, 3>> triangulatePolygon(std::span<const glm::vec3> corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  if (corners.size() == 3) return {{0, 1, 2}};
  const std::vector<glm::dvec2> flat = flatten(corners);
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  // Ear clipping is cubic in the worst case; beyond this size a fan is drawn instead, as every reader of such files does.
  constexpr std::size_t kMaxEars = 2048;
  const Ask first = corners.size() <= kMaxEars ? Ask::kNothingTouches : Ask::kAnything;
  // From the second corner on: what is convex becomes a fan around the first, as every other reader cuts it, and quads are seldom flat.
  std::size_t at = 1, tried = 0;
  Ask ask = first;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    if (isEar(flat, left, at, ask)) {
      triangles.push_back({left[(at + n - 1) % n], left[at], left[(at + 1) % n]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
      at %= left.size();
      tried = 0;
      ask = first;
    } else {
      at = (at + 1) % n;
      if (++tried == n) {
        ask = static_cast<Ask>(static_cast<int>(ask) + 1);
        tried = 0;
      }
    }
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace kelp::bake

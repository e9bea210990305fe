// SPDX-License-Identifier: MIT
#include "import_soup.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace kelp::bake {
namespace {

float cross2(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon in its own plane, wound counter-clockwise: drops the axis in which Newell's normal is longest.
std::vector<glm::vec2> flatten(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = corners[i] - corners[0];
    const glm::dvec3 b = corners[(i + 1) % corners.size()] - corners[0];
    normal += glm::cross(a, b);
  }
  const glm::dvec3 size = glm::abs(normal);
  int drop = 2;
  if (size.x >= size.y && size.x >= size.z) drop = 0;
  else if (size.y >= size.z) drop = 1;
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<glm::vec2> flat;
  flat.reserve(corners.size());
  for (const glm::vec3& corner : corners) flat.emplace_back(corner[u] - corners[0][u], corner[v] - corners[0][v]);
  return flat;
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
  // The attribute lists are empty or complete: the first triangle that has one fills in for those before it.
  if (triangle.uv && soup_.uvs.empty()) soup_.uvs.resize(soup_.triangles.size());
  if (triangle.color && soup_.colors.empty()) soup_.colors.resize(soup_.triangles.size(), {glm::vec4(1), glm::vec4(1), glm::vec4(1)});
  const bool had_uvs = triangle.uv || !soup_.uvs.empty();
  const bool had_colors = triangle.color || !soup_.colors.empty();
  soup_.triangles.push_back(entry);
  if (had_uvs) soup_.uvs.push_back(triangle.uv.value_or(std::array<glm::vec2, 3>{glm::vec2(0), glm::vec2(0), glm::vec2(0)}));
  if (had_colors) soup_.colors.push_back(triangle.color.value_or(std::array<glm::vec4, 3>{glm::vec4(1), glm::vec4(1), glm::vec4(1)}));
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
  const std::vector<glm::vec2> flat = flatten(corners);
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  // Ear clipping is cubic in the worst case; beyond this size a fan is drawn instead, as every reader of such files does.
  constexpr std::size_t kMaxEars = 2048;
  // From the second corner on: what is convex becomes a fan around the first, as every other reader cuts it, and quads are seldom flat.
  std::size_t at = 1, tried = 0;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    const std::uint32_t a = left[(at + n - 1) % n], b = left[at % n], c = left[(at + 1) % n];
    bool ear = cross2(flat[a], flat[b], flat[c]) > 0;
    for (std::size_t i = 0; ear && i < n && corners.size() <= kMaxEars; ++i) {
      const std::uint32_t p = left[i];
      if (p == a || p == b || p == c) continue;
      if (cross2(flat[a], flat[b], flat[p]) >= 0 && cross2(flat[b], flat[c], flat[p]) >= 0 && cross2(flat[c], flat[a], flat[p]) >= 0) ear = false;
    }
    if (ear || tried >= n) {  // no ear left: self-intersecting or flat, cut anyway
      triangles.push_back({a, b, c});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at % n));
      at = at % n % left.size();
      tried = 0;
    } else {
      at = (at + 1) % n;
      ++tried;
    }
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace kelp::bake

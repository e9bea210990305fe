// SPDX-License-Identifier: MIT
#include "kelp/import/mesh/soup.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kelp::bake {
namespace {

constexpr double kMostFloat = std::numeric_limits<float>::max();

// Attribute lists are empty or complete: the first triangle with an attribute fills in `missing` for those
// before it.
template <class T>
void append(std::vector<std::array<T, 3>>& list, const std::optional<std::array<T, 3>>& value,
            std::size_t before, const T& none) {
  if (!value && list.empty()) return;
  const std::array<T, 3> missing{none, none, none};
  list.resize(before, missing);
  list.push_back(value.value_or(missing));
}

}  // namespace

std::uint32_t SoupBuilder::vertex(const glm::vec3& position) {
  const std::uint32_t number = index_.of(position + 0.0f, soup_.positions);  // -0 and +0 are one position
  if (piece_.size() < soup_.positions.size()) piece_.push_back(static_cast<std::uint32_t>(steps_.size() - 1));
  return number;
}

bool SoupBuilder::add(const Triangle& triangle) {
  if (soup_.triangles.size() >= kMaxTriangles) return false;
  for (const glm::vec3& p : triangle.position) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      ++non_finite_;
      return true;
    }
  }
  if (triangle.position[0] == triangle.position[1] || triangle.position[1] == triangle.position[2] ||
      triangle.position[2] == triangle.position[0]) {
    ++degenerate_;
    return true;
  }
  TriangleSoup::Triangle entry;
  for (std::size_t i = 0; i < 3; ++i) entry.vertex[i] = vertex(triangle.position[i]);
  entry.material = triangle.material;
  append(soup_.uvs, triangle.uv, soup_.triangles.size(), glm::vec2(0));
  for (std::size_t i = 0; i < soup_.more_uvs.size(); ++i)
    append(soup_.more_uvs[i], triangle.more_uv[i], soup_.triangles.size(), glm::vec2(0));
  append(soup_.colors, triangle.color, soup_.triangles.size(), glm::vec4(1));
  append(soup_.skinned, triangle.skinned, soup_.triangles.size(), 0u);
  soup_.triangles.push_back(entry);
  return true;
}

bool isFar(const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 extent = high - low, reach = glm::max(glm::abs(low), glm::abs(high));
  return std::max({reach.x, reach.y, reach.z}) > 16 * std::max({extent.x, extent.y, extent.z});
}

std::optional<glm::dvec3> floatMiddle(const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 middle = 0.5 * low + 0.5 * high;
  if (!(std::max({std::abs(middle.x), std::abs(middle.y), std::abs(middle.z)}) <= kMostFloat))
    return std::nullopt;
  return glm::dvec3(glm::vec3(middle));
}

glm::dvec3 farMiddle(std::span<const glm::dvec3> positions) {
  glm::dvec3 low(kMostFloat), high(-kMostFloat);
  for (const glm::dvec3& p : positions) {
    if (!(std::abs(p.x) <= kMostFloat && std::abs(p.y) <= kMostFloat && std::abs(p.z) <= kMostFloat))
      continue;
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  if (!(low.x <= high.x) || !isFar(low, high)) return glm::dvec3(0);
  return floatMiddle(low, high).value_or(glm::dvec3(0));
}

void SoupBuilder::roundedTo(float step, const glm::dmat4& to_soup, double unit) {
  const auto isSame = [&](const Lattice& other) {
    if (other.unit != unit || glm::dmat3(other.to_soup) != glm::dmat3(to_soup)) return false;
    const glm::dvec3 apart =
        glm::inverse(glm::dmat3(to_soup)) * glm::dvec3(to_soup[3] - other.to_soup[3]) / unit;
    // false if there is no inverse
    return glm::all(glm::lessThanEqual(glm::abs(apart - glm::round(apart)), glm::dvec3(1e-6)));
  };
  if (lattice_ && isSame(*lattice_)) return;
  roundedTo(step);
  lattice_ = {to_soup, unit};
}

void SoupBuilder::roundedTo(float step) {
  lattice_.reset();
  steps_.push_back(step > 0 && std::isfinite(step) ? step : 0.0f);
}

TriangleSoup SoupBuilder::take() {
  index_ = {};
  soup_.dropped = non_finite_ + degenerate_;
  if (*std::max_element(steps_.begin(), steps_.end()) > 0) closeSeams(soup_, piece_, steps_);
  return std::move(soup_);
}

}  // namespace kelp::bake

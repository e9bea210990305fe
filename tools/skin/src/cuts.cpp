// SPDX-License-Identifier: MIT
#include "cuts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kelp/common/dense_index.h"
#include "kelp/fields/cages.h"

namespace kelp::bake {
namespace {

// Samples whose weights differ by less stay together. 1: no joint in common.
constexpr double kAlike = 0.4;
// The mesh joins two samples if it does so within so many voxels.
constexpr double kNear = 4;
constexpr std::uint32_t kNoSample = 0xffffffffu;

double weightDifference(std::span<const SkinSamples::Weighted> a, std::span<const SkinSamples::Weighted> b) {
  double shared = 0;
  for (const SkinSamples::Weighted& one : a)
    for (const SkinSamples::Weighted& other : b)
      if (one.joint == other.joint) shared += std::min(one.weight, other.weight);
  return 1 - shared;
}

// Calls visit(voxel) for the voxels of a box around one that are solid.
template <class Visit>
void forEachSolid(const fields::SolidBits& solid, const glm::ivec3& middle, int reach, const Visit& visit) {
  const glm::ivec3 low = glm::max(middle - reach, 0), high = glm::min(middle + reach, solid.size() - 1);
  glm::ivec3 at{0};
  for (at.z = low.z; at.z <= high.z; ++at.z)
    for (at.y = low.y; at.y <= high.y; ++at.y)
      for (at.x = low.x; at.x <= high.x; ++at.x)
        if (solid.isSolid(at)) visit(at);
}

glm::ivec3 voxelAround(const glm::ivec3& size, const glm::dvec3& at) {
  return glm::ivec3(glm::clamp(glm::floor(at), glm::dvec3(0), glm::dvec3(size - 1)));
}

double squaredDistance(const glm::ivec3& voxel, const glm::dvec3& point) {
  const glm::dvec3 apart = glm::dvec3(voxel) + 0.5 - point;
  return glm::dot(apart, apart);
}

}  // namespace

SkinCuts::SkinCuts(const TriangleSoup& soup, const Frame& frame, const SkinSamples& samples,
                   const fields::SolidBits& solid)
    : samples_(samples), solid_(solid) {
  for (const glm::vec3& at : soup.positions)
    corners_.emplace_back(frame.node_to_voxel * glm::dvec4(glm::dvec3(at), 1));
  first_at_.assign(corners_.size() + 1, 0);
  for (const TriangleSoup::Triangle& t : soup.triangles) {
    triangles_.push_back(t.vertex);
    for (const std::uint32_t vertex : t.vertex) ++first_at_[vertex + 1];
  }
  for (std::size_t v = 0; v < corners_.size(); ++v) first_at_[v + 1] += first_at_[v];
  at_.resize(3 * triangles_.size());
  std::vector<std::size_t> next = first_at_;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t vertex : triangles_[t]) at_[next[vertex]++] = t;

  const glm::ivec3& size = solid.size();
  owners_.assign(denseCount(size), kNoSample);
  const int reach = std::max(1, static_cast<int>(std::ceil(samples.spacing / 1.5)));
  for (std::uint32_t s = 0; s < samples.size(); ++s) {
    const glm::dvec3& point = samples.positions[s];
    forEachSolid(solid, voxelAround(size, point), reach, [&](const glm::ivec3& at) {
      std::uint32_t& owner = owners_[denseIndex(size, at)];
      if (owner == kNoSample || squaredDistance(at, point) < squaredDistance(at, samples.positions[owner]))
        owner = s;
    });
  }
  for (std::size_t i = 0; i < owners_.size(); ++i) {
    if (owners_[i] == kNoSample) continue;
    const glm::ivec3 at = voxelAt(size, i);
    for (int code = 14; code < 27; ++code) {
      const glm::ivec3 by(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1), to = at + by;
      if (glm::clamp(to, glm::ivec3(0), size - 1) != to) continue;
      const std::uint32_t other = owners_[denseIndex(size, to)];
      if (other == kNoSample || !areApart(samples, owners_[i], samples, other)) continue;
      if (cuts_.empty()) cuts_.assign(owners_.size(), 0);
      cuts_[i] |= fields::cutBit(by);
    }
  }
}

bool SkinCuts::areApart(const SkinSamples& a, std::size_t i, const SkinSamples& b, std::size_t j) {
  if (a.triangles[i] == b.triangles[j] || weightDifference(a.weights(i), b.weights(j)) <= kAlike)
    return false;
  const auto [joined, fresh] = joined_.try_emplace({a.triangles[i], b.triangles[j]}, false);
  if (fresh)
    joined->second = areJoined(a.triangles[i], b.triangles[j], 0.5 * (a.positions[i] + b.positions[j]));
  return !joined->second;
}

// Over triangles that share vertices, near a point.
bool SkinCuts::areJoined(std::uint32_t from, std::uint32_t to, const glm::dvec3& near) const {
  std::vector<std::uint32_t> reached{from};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i] == to) return true;
    for (const std::uint32_t vertex : triangles_[reached[i]])
      for (std::size_t k = first_at_[vertex]; k < first_at_[vertex + 1]; ++k)
        if (std::find(reached.begin(), reached.end(), at_[k]) == reached.end() &&
            distanceTo(at_[k], near) <= kNear)
          reached.push_back(at_[k]);
  }
  return false;
}

// Of the nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double SkinCuts::distanceTo(std::uint32_t triangle, const glm::dvec3& p) const {
  const glm::dvec3 &a = corners_[triangles_[triangle][0]], &b = corners_[triangles_[triangle][1]],
                   &c = corners_[triangles_[triangle][2]];
  const auto along = [&](const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 edge = to - from;
    const double length = glm::dot(edge, edge);
    const double share = length > 0 ? std::clamp(glm::dot(p - from, edge) / length, 0.0, 1.0) : 0.0;
    return glm::distance(p, from + share * edge);
  };
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double area = glm::length(normal);
  const auto isInner = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  if (area > 0 && isInner(a, b) && isInner(b, c) && isInner(c, a))
    return std::abs(glm::dot(p - a, normal)) / area;
  return std::min({along(a, b), along(b, c), along(c, a)});
}

std::optional<glm::ivec3> SkinCuts::voxelOf(const SkinSamples& of, std::size_t i) {
  constexpr int kFarthest = 6;
  const glm::dvec3& point = of.positions[i];
  const glm::ivec3 middle = voxelAround(solid_.size(), point);
  for (const int reach : {1, 2, kFarthest}) {
    std::optional<glm::ivec3> best;
    forEachSolid(solid_, middle, reach, [&](const glm::ivec3& at) {
      if (best && squaredDistance(at, point) >= squaredDistance(*best, point)) return;
      const std::uint32_t owner = cuts_.empty() ? kNoSample : owners_[denseIndex(solid_.size(), at)];
      if (owner == kNoSample || !areApart(of, i, samples_, owner)) best = at;
    });
    // All beyond the reach is at least so far away.
    if (best && (reach == kFarthest || squaredDistance(*best, point) <= reach * reach)) return best;
  }
  return std::nullopt;
}

}  // namespace kelp::bake

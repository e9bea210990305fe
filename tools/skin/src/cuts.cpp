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
// So do those that morph targets move apart by less; voxels.
constexpr double kGap = 1;
// The mesh joins two samples if it does so within so many voxels of the middle of a cube of kPlace^3.
constexpr double kNear = 6;
constexpr double kPlace = 4;
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

double distanceToEdge(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& p) {
  const glm::dvec3 edge = to - from;
  const double length = glm::dot(edge, edge);
  const double share = length > 0 ? std::clamp(glm::dot(p - from, edge) / length, 0.0, 1.0) : 0.0;
  return glm::distance(p, from + share * edge);
}

double squaredDistance(const glm::ivec3& voxel, const glm::dvec3& point) {
  const glm::dvec3 apart = glm::dvec3(voxel) + 0.5 - point;
  return glm::dot(apart, apart);
}

}  // namespace

SkinCuts::SkinCuts(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
                   const SkinSamples& samples, const fields::SolidBits& solid)
    : samples_(samples), solid_(solid), gaps_(soup, skin, frame) {
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
  // Two surfaces that touch are about as near. A voxel is behind its own, and in front of the other.
  constexpr double kInFront = 1e3;
  std::vector<float> costs(owners_.size());
  for (std::uint32_t s = 0; s < samples.size(); ++s) {
    const glm::dvec3& point = samples.positions[s];
    const auto& [a, b, c] = triangles_[samples.triangles[s]];
    const glm::dvec3 normal = glm::cross(corners_[b] - corners_[a], corners_[c] - corners_[a]);
    forEachSolid(solid, voxelAround(size, point), reach, [&](const glm::ivec3& at) {
      const bool in_front = glm::dot(glm::dvec3(at) + 0.5 - point, normal) > 0;
      const double off = distanceTo(samples.triangles[s], glm::dvec3(at) + 0.5);
      // Of one triangle, the nearest sample.
      const auto cost =
          static_cast<float>(off + 1e-3 * squaredDistance(at, point) + (in_front ? kInFront : 0));
      const std::size_t i = denseIndex(size, at);
      if (owners_[i] != kNoSample && cost >= costs[i]) return;
      owners_[i] = s;
      costs[i] = cost;
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
  if (a.triangles[i] == b.triangles[j]) return false;
  const bool differ = weightDifference(a.weights(i), b.weights(j)) > kAlike;
  if (!differ && gaps_.none()) return false;
  const glm::ivec3 place(glm::floor(0.5 / kPlace * (a.positions[i] + b.positions[j])));
  Surfaces& here = surfaces_[{place.x, place.y, place.z}];
  const glm::dvec3 middle = kPlace * (glm::dvec3(place) + 0.5);
  return surfaceOf(a.triangles[i], middle, here) != surfaceOf(b.triangles[j], middle, here) &&
         (differ || gaps_.between(a, i, b, j) > kGap);
}

// Over vertices and edges that are near a point. All triangles of a surface are found with the first.
std::uint32_t SkinCuts::surfaceOf(std::uint32_t triangle, const glm::dvec3& near, Surfaces& found) const {
  if (const auto known = found.find(triangle); known != found.end()) return known->second;
  const std::uint32_t surface = triangle;
  std::vector<std::uint32_t> open{triangle};
  found.emplace(triangle, surface);
  const auto join = [&](std::uint32_t one) {
    if (found.emplace(one, surface).second) open.push_back(one);
  };
  while (!open.empty()) {
    const std::array<std::uint32_t, 3> corners = triangles_[open.back()];
    open.pop_back();
    for (std::size_t v = 0; v < 3; ++v) {
      const std::uint32_t from = corners[v], to = corners[(v + 1) % 3];
      const bool at_corner = glm::distance(corners_[from], near) <= kNear,
                 at_edge = distanceToEdge(corners_[from], corners_[to], near) <= kNear;
      for (std::size_t k = first_at_[from]; (at_corner || at_edge) && k < first_at_[from + 1]; ++k) {
        const std::array<std::uint32_t, 3>& other = triangles_[at_[k]];
        if (at_corner || std::find(other.begin(), other.end(), to) != other.end()) join(at_[k]);
      }
    }
  }
  return surface;
}

// Of the nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double SkinCuts::distanceTo(std::uint32_t triangle, const glm::dvec3& p) const {
  const glm::dvec3 &a = corners_[triangles_[triangle][0]], &b = corners_[triangles_[triangle][1]],
                   &c = corners_[triangles_[triangle][2]];
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double area = glm::length(normal);
  const auto isInner = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  if (area > 0 && isInner(a, b) && isInner(b, c) && isInner(c, a))
    return std::abs(glm::dot(p - a, normal)) / area;
  return std::min({distanceToEdge(a, b, p), distanceToEdge(b, c, p), distanceToEdge(c, a, p)});
}

std::optional<glm::ivec3> SkinCuts::voxelOf(const SkinSamples& of, std::size_t i) {
  constexpr int kFarthest = 6;
  const glm::dvec3& point = of.positions[i];
  const glm::ivec3 middle = voxelAround(solid_.size(), point);
  for (const int reach : {1, 2, kFarthest}) {
    std::optional<glm::ivec3> best;
    forEachSolid(solid_, middle, reach, [&](const glm::ivec3& at) {
      if (best && squaredDistance(at, point) >= squaredDistance(*best, point)) return;
      const std::uint32_t owner = owners_[denseIndex(solid_.size(), at)];
      if (owner == kNoSample || !areApart(of, i, samples_, owner)) best = at;
    });
    // All beyond the reach is at least so far away.
    if (best && (reach == kFarthest || squaredDistance(*best, point) <= reach * reach)) return best;
  }
  return std::nullopt;
}

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
#include "change_rules.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace kelp::bake {
namespace {

// The six cells across the faces of the middle one of 27.
constexpr int kFaces[6] = {4, 10, 12, 14, 16, 22};

// A voxel with at most this many neighbors is the end of a tip, and stays.
constexpr int kTip = 2;
// Heights that differ by less than this part of a voxel are equal, so that rounding decides nothing.
constexpr double kStep = 1.0 / 1024;
glm::ivec3 step(int cell) { return {cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1}; }

// For each of 27 cells, those across its faces; the middle and the corners of the block are left out.
struct Beside {
  std::uint32_t mask[27] = {};

  Beside() {
    for (int a = 0; a < 27; ++a) {
      for (int b = 0; b < 27; ++b) {
        const glm::ivec3 apart = glm::abs(step(a) - step(b)), corner = glm::abs(step(b));
        const int sum = corner.x + corner.y + corner.z;
        if (apart.x + apart.y + apart.z == 1 && sum != 0 && sum != 3) mask[a] |= 1u << b;
      }
    }
  }
};

// True if the empty voxels across the faces of a voxel with these neighbors are connected around it.
bool emptyHangTogether(std::uint32_t solid) {
  static const Beside beside;
  std::uint32_t faces = 0;
  for (const int face : kFaces) faces |= solid & (1u << face) ? 0 : 1u << face;
  if (faces == 0) return false;
  std::uint32_t reached = faces & (0u - faces), frontier = reached;
  while (frontier != 0) {
    std::uint32_t grown = 0;
    for (int cell = 0; cell < 27; ++cell) {
      if (frontier & (1u << cell)) grown |= beside.mask[cell];
    }
    frontier = grown & ~solid & ~reached;
    reached |= frontier;
  }
  return (faces & ~reached) == 0;
}

// True if a voxel with these neighbors, solid or empty as `filled` says, leaves two solid voxels that share
// nothing but an edge of it: rays slip through there.
bool leaks(std::uint32_t solid, bool filled) {
  for (int first = 0; first < 6; ++first) {
    for (int second = first + 1; second < 6; ++second) {
      const int a = kFaces[first], b = kFaces[second];
      if (a + b == 26) continue;  // opposite faces
      const bool at_a = solid & (1u << a), at_b = solid & (1u << b), beyond = solid & (1u << (a + b - 13));
      if (filled ? !at_a && !at_b && beyond : at_a && at_b && !beyond) return true;
    }
  }
  return false;
}

}  // namespace

void ChangeRules::findNear(int threads, const Step& step) {
  near_.resize(touched_.size());
  parallelRanges(
      touched_.size(), 4096, threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) near_[i] = nearest(touched_[i]);
      },
      step);
}

void ChangeRules::addEdges(std::vector<std::size_t>& side) const {
  std::vector<std::uint8_t> seen(touched_.size(), 0);
  for (const std::size_t i : side) seen[i] = 1;
  const Near& its = near_[side.front()];
  for (std::size_t at = 0; at < side.size(); ++at) {
    const glm::ivec3 voxel = voxelAt(size_, touched_[side[at]]);
    for (const int face : kFaces) {
      if (face == its.below || face == 26 - its.below) continue;
      const glm::ivec3 beside = voxel + step(face);
      const Near* near = nearAt(beside);
      if (near == nullptr || near->component != its.component || near->sheet || near->height < its.height ||
          this->at(beside) != kInside || this->at(beside + step(its.below)) == kEmpty ||
          this->at(beside - step(its.below)) != kEmpty)
        continue;
      const std::size_t i = static_cast<std::size_t>(near - near_.data());
      if (!seen[i]) side.push_back(i);
      seen[i] = 1;
    }
  }
}

bool ChangeRules::isRim(std::size_t i, int below) const {
  const std::uint32_t around = neighborMask(voxels_, size_, voxelAt(size_, touched_[i]));
  return std::any_of(std::begin(kFaces), std::end(kFaces), [&](int face) {
    return face != below && face != 26 - below && (around & (1u << face | 1u << (26 - face))) == 0;
  });
}

bool ChangeRules::mayChange(std::size_t i, int below) const {
  const std::uint64_t index = touched_[i];
  const glm::ivec3 voxel = voxelAt(size_, index);
  const std::uint32_t around = neighborMask(voxels_, size_, voxel) & ~kCenterBit;
  if ((around & (1u << below)) == 0 || std::popcount(around) <= kTip || !hangTogether(around) ||
      !emptyHangTogether(around))
    return false;
  const bool goes = isSolidAt(index);
  if (leaks(around, !goes) || !isOwn(voxel + step(below), near_[i].component)) return false;
  if (!goes) return true;
  for (const int face : kFaces) {
    if (around & (1u << face)) continue;
    const glm::ivec3 beside = voxel + step(face);
    if (isTouched(beside) && solidFaces(beside) < 2) return false;
  }
  return true;
}

Nearest ChangeRules::nearestDrawn(const glm::dvec3& center) const {
  return bvh_.nearest(center, kHalfDiagonal,
                      [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
}

ChangeRules::Near ChangeRules::nearest(std::uint64_t index) const {
  const glm::dvec3 center = glm::dvec3(voxelAt(size_, index)) + 0.5;
  const Nearest nearest = nearestDrawn(center);
  if (nearest.triangle == kCap || !isSolid(nearest.triangle)) return {};
  const bool sheet =
      bvh_.nearest(center, kHalfDiagonal, [&](std::uint32_t i) { return !isSolid(i); }).triangle != kCap;
  const bool inside = voxels_[index] == kInside;
  // Towards the inside. On the surface itself that is against the triangle's normal.
  glm::dvec3 down = glm::round((inside ? center - nearest.point : nearest.point - center) / kStep);
  if (down == glm::dvec3(0)) down = -mesh_.areaVector(mesh_.triangles[nearest.triangle]);
  const glm::dvec3 size = glm::abs(down);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  constexpr int kStride[3] = {1, 3, 9};
  const double height = std::round(std::sqrt(nearest.squared) / kStep) * kStep;
  const glm::dvec3 away = glm::abs(nearest.point - center);
  Near near;
  near.component = mesh_.triangles[nearest.triangle].component;
  near.height = static_cast<float>(inside ? -height : height);
  near.below = static_cast<std::uint8_t>(13 + (down[axis] > 0 ? kStride[axis] : -kStride[axis]));
  near.sheet = sheet;
  near.through = std::max({away.x, away.y, away.z}) <= 0.5;
  return near;
}

bool ChangeRules::isTouched(const glm::ivec3& v) const {
  const Near* near = nearAt(v);
  return near != nullptr && near->through;
}

const ChangeRules::Near* ChangeRules::nearAt(const glm::ivec3& v) const {
  if (!isWithin(v)) return nullptr;
  const auto at = std::lower_bound(touched_.begin(), touched_.end(), denseIndex(size_, v));
  return at != touched_.end() && *at == denseIndex(size_, v)
             ? &near_[static_cast<std::size_t>(at - touched_.begin())]
             : nullptr;
}

bool ChangeRules::isOwn(const glm::ivec3& v, std::uint32_t component) const {
  if (const Near* near = nearAt(v)) return near->component == component;
  const Nearest nearest = nearestDrawn(glm::dvec3(v) + 0.5);
  return nearest.triangle == kCap ||
         (isSolid(nearest.triangle) && mesh_.triangles[nearest.triangle].component == component);
}

int ChangeRules::solidFaces(const glm::ivec3& v) const {
  return static_cast<int>(std::count_if(std::begin(kFaces), std::end(kFaces),
                                        [&](int face) { return at(v + step(face)) != kEmpty; }));
}

}  // namespace kelp::bake

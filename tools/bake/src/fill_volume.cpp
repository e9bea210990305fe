// SPDX-License-Identifier: MIT
#include "fill_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "fill_thin.h"
#include "parallel.h"

namespace kelp::bake {
namespace {

// The six cells across the faces of the middle one of 27.
constexpr int kFaces[6] = {4, 10, 12, 14, 16, 22};
// With no more neighbours a voxel is the end of a tip.
constexpr int kTip = 2;
// What the voxels may differ by from the volume.
constexpr double kSlack = 0.005;
// With more than this share of its surface within or against others a body's own volume is not what is seen.
constexpr double kMaxShared = 0.05;
// With more than this share of its surface in caps a body's volume is a guess.
constexpr double kMaxCaps = 0.01;
// So many voxels of one height are a flat side along the grid.
constexpr std::size_t kFlat = 32;
// Farther from the surface no voxel changes: a side would move by a voxel.
constexpr float kReach = 0.49f;
// Heights are told apart to this part of a voxel, and not by how they were rounded.
constexpr double kStep = 1.0 / 1024;

glm::ivec3 step(int cell) { return {cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1}; }

// Of each cell those across its faces, without the corners of the block of 27 and its middle.
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

// Whether the empty voxels at the faces of a voxel with these neighbours hang together around it.
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

// Whether some edge of a voxel with these neighbours would be all that two solid voxels share, with the voxel as asked: rays slip through there.
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

class Matcher {
 public:
  Matcher(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched, const glm::ivec3& size, const std::vector<std::uint8_t>& voxels)
      : mesh_(mesh), bvh_(bvh), touched_(touched), size_(size), voxels_(voxels) {}

  // The body that passes near a voxel.
  struct Near {
    std::uint32_t component = kCap;  // kCap: none
    float height = 0;                // of the voxel's centre above its surface, voxels
    std::uint8_t below = 0;          // the cell across the face that looks into the body
    bool sheet = false;              // a sheet or a wall passes near it too
    bool through = false;            // the nearest point of the body lies in the voxel

    bool sameSide(const Near& other) const { return height == other.height && component == other.component && below == other.below; }
  };
  void findNear(int threads, const Step& step) {
    near_.resize(touched_.size());
    parallelRanges(touched_.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) near_[i] = nearest(touched_[i]);
    }, step);
  }
  // Of the touched voxel with that number.
  const Near& near(std::size_t i) const { return near_[i]; }

  bool isSolidAt(std::uint64_t index) const { return voxels_[index] != kEmpty; }

  // Adds to the solid voxels of a flat side those at its edges, which lie nearer to the sides around: without them it would leave a ridge.
  void addEdges(std::vector<std::size_t>& side) const {
    std::vector<std::uint8_t> seen(touched_.size(), 0);
    for (const std::size_t i : side) seen[i] = 1;
    const Near& its = near_[side.front()];
    for (std::size_t at = 0; at < side.size(); ++at) {
      const glm::ivec3 voxel = voxelAt(touched_[side[at]]);
      for (const int face : kFaces) {
        if (face == its.below || face == 26 - its.below) continue;
        const glm::ivec3 beside = voxel + step(face);
        const Near* near = nearAt(beside);
        if (near == nullptr || near->component != its.component || near->sheet || near->height < its.height || this->at(beside) != kInside ||
            this->at(beside + step(its.below)) == kEmpty || this->at(beside - step(its.below)) != kEmpty) continue;
        const std::size_t i = static_cast<std::size_t>(near - near_.data());
        if (!seen[i]) side.push_back(i);
        seen[i] = 1;
      }
    }
  }

  // Whether a solid voxel is the rim of a plate or the side of a blade: empty on both sides, across what is beneath it.
  bool isRim(std::size_t i, int below) const {
    const std::uint32_t around = neighbourMask(voxels_, size_, voxelAt(touched_[i]));
    return std::any_of(std::begin(kFaces), std::end(kFaces), [&](int face) {
      return face != below && face != 26 - below && (around & (1u << face | 1u << (26 - face))) == 0;
    });
  }

  // Whether a solid voxel may go, or an empty one come.
  bool mayChange(std::size_t i, int below) const {
    const std::uint64_t index = touched_[i];
    const glm::ivec3 voxel = voxelAt(index);
    const std::uint32_t around = neighbourMask(voxels_, size_, voxel) & ~kCentreBit;
    if ((around & (1u << below)) == 0 || std::popcount(around) <= kTip || !hangTogether(around) || !emptyHangTogether(around)) return false;
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

 private:
  Near nearest(std::uint64_t index) const {
    const glm::dvec3 centre = glm::dvec3(voxelAt(index)) + 0.5;
    const Nearest nearest = bvh_.nearest(centre, kHalfDiagonal, [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
    if (nearest.triangle == kCap || !isSolid(nearest.triangle)) return {};
    const bool sheet = bvh_.nearest(centre, kHalfDiagonal, [&](std::uint32_t i) { return !isSolid(i); }).triangle != kCap;
    const bool inside = voxels_[index] == kInside;
    // Towards the inside. Of a point on the surface the triangle tells.
    glm::dvec3 down = glm::round((inside ? centre - nearest.point : nearest.point - centre) / kStep);
    if (down == glm::dvec3(0)) down = -mesh_.areaVector(mesh_.triangles[nearest.triangle]);
    const glm::dvec3 size = glm::abs(down);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    constexpr int kStride[3] = {1, 3, 9};
    const double height = std::round(std::sqrt(nearest.squared) / kStep) * kStep;
    const glm::dvec3 away = glm::abs(nearest.point - centre);
    Near near;
    near.component = mesh_.triangles[nearest.triangle].component;
    near.height = static_cast<float>(inside ? -height : height);
    near.below = static_cast<std::uint8_t>(13 + (down[axis] > 0 ? kStride[axis] : -kStride[axis]));
    near.sheet = sheet;
    near.through = std::max({away.x, away.y, away.z}) <= 0.5;
    return near;
  }
  bool isSolid(std::uint32_t triangle) const { return mesh_.components[mesh_.triangles[triangle].component].solid; }
  bool isWithin(const glm::ivec3& v) const { return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_.x && v.y < size_.y && v.z < size_.z; }
  std::size_t indexOf(const glm::ivec3& v) const {
    return static_cast<std::size_t>(v.x) + static_cast<std::size_t>(size_.x) * (static_cast<std::size_t>(v.y) + static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(v.z));
  }
  glm::ivec3 voxelAt(std::uint64_t index) const {
    const std::uint64_t x = static_cast<std::uint64_t>(size_.x), y = static_cast<std::uint64_t>(size_.y);
    return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y))};
  }
  std::uint8_t at(const glm::ivec3& v) const { return isWithin(v) ? voxels_[indexOf(v)] : static_cast<std::uint8_t>(kEmpty); }
  // What is near a voxel; null if no triangle is.
  const Near* nearAt(const glm::ivec3& v) const {
    if (!isWithin(v)) return nullptr;
    const auto at = std::lower_bound(touched_.begin(), touched_.end(), indexOf(v));
    return at != touched_.end() && *at == indexOf(v) ? &near_[static_cast<std::size_t>(at - touched_.begin())] : nullptr;
  }
  bool isTouched(const glm::ivec3& v) const {
    const Near* near = nearAt(v);
    return near != nullptr && near->through;
  }
  // Whether a solid voxel is of that body, and not of another that lies against it. Deep ones are of the body around them.
  bool isOwn(const glm::ivec3& v, std::uint32_t component) const {
    const Near* near = nearAt(v);
    return near == nullptr || near->component == component;
  }
  int solidFaces(const glm::ivec3& v) const {
    return static_cast<int>(std::count_if(std::begin(kFaces), std::end(kFaces), [&](int face) { return at(v + step(face)) != kEmpty; }));
  }

  const Topology& mesh_;
  const TriangleBvh& bvh_;
  const std::vector<std::uint64_t>& touched_;
  glm::ivec3 size_;
  const std::vector<std::uint8_t>& voxels_;
  std::vector<Near> near_;
};

}  // namespace

void matchVolumes(const Topology& mesh, const std::vector<Scanned>& scanned, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched, const glm::ivec3& size,
                  int threads, std::vector<std::uint8_t>& voxels, const Step& step) {
  // How many voxels each component has too many; less than none: too few. First without the kept ones, of which nobody has asked yet whose they are.
  const std::size_t components = mesh.components.size();
  std::vector<double> volume(components, 0), surplus(components, 0);
  std::vector<std::uint8_t> alone(components, 0);
  double all = 0, volumes = 0;
  for (std::size_t c = 0; c < components; ++c) {
    const Component& body = mesh.components[c];
    if (!body.solid || body.thin || body.cap_area > kMaxCaps * body.area || static_cast<double>(scanned[c].shared) > kMaxShared * static_cast<double>(scanned[c].faces)) continue;
    alone[c] = 1;
    volume[c] = std::abs(body.volume) - static_cast<double>(scanned[c].wound - scanned[c].length) * kLatticeStep;
    surplus[c] = static_cast<double>(scanned[c].centres) - volume[c];
    all += surplus[c];
    volumes += volume[c];
  }
  const auto kept = std::count_if(touched.begin(), touched.end(), [&](std::uint64_t index) { return voxels[index] == kKept; });
  if (std::abs(all) + static_cast<double>(kept) <= kSlack * volumes || volumes <= 0) return;

  Matcher matcher(mesh, bvh, touched, size, voxels);
  matcher.findNear(threads, step);
  std::vector<std::size_t> nears(components, 0), sheets(components, 0);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    const Matcher::Near& near = matcher.near(i);
    if (near.component == kCap) continue;
    ++nears[near.component];
    if (near.sheet) ++sheets[near.component];
    if (voxels[touched[i]] == kKept) surplus[near.component] += 1;
  }
  all = volumes = 0;
  for (std::size_t c = 0; c < components; ++c) {
    if (static_cast<double>(sheets[c]) > kMaxShared * static_cast<double>(nears[c])) alone[c] = 0;
    if (!alone[c]) continue;
    all += surplus[c];
    volumes += volume[c];
  }
  if (std::abs(all) <= kSlack * volumes) return;
  const bool too_many = all > 0;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < touched.size(); ++i) {
    const Matcher::Near& near = matcher.near(i);
    if (near.component != kCap && alone[near.component] && !near.sheet && std::abs(near.height) <= kReach && matcher.isSolidAt(touched[i]) == too_many) order.push_back(i);
  }
  // Of those to go the highest first, of those to come the lowest.
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Matcher::Near &its = matcher.near(a), &other = matcher.near(b);
    if (its.height != other.height) return (its.height > other.height) == too_many;
    return std::tie(its.component, its.below, a) < std::tie(other.component, other.below, b);
  });
  const double change = too_many ? -1 : 1;
  for (std::size_t begin = 0, end = 0; begin < order.size() && std::abs(all) > kSlack * volumes; begin = end) {
    // A flat side along the grid changes as a whole, or else it would get a step.
    const Matcher::Near& its = matcher.near(order[begin]);
    while (end < order.size() && matcher.near(order[end]).sameSide(its)) ++end;
    std::vector<std::size_t> side(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end));
    if (too_many && side.size() >= kFlat) {
      // It may have lost some already, as the edge of another.
      std::erase_if(side, [&](std::size_t i) { return !matcher.isSolidAt(touched[i]); });
      if (side.empty()) continue;
      matcher.addEdges(side);
    }
    const double after = static_cast<double>(side.size()) * change;
    double& body = surplus[its.component];
    if (std::abs(body + after) > std::abs(body) || std::abs(all + after) > std::abs(all)) continue;
    std::vector<std::uint8_t> rim(side.size(), 0);
    for (std::size_t at = 0; too_many && at < side.size(); ++at) rim[at] = matcher.isRim(side[at], its.below) ? 1 : 0;
    // One after the other, since each changes what its neighbours may do.
    std::vector<std::pair<std::uint64_t, std::uint8_t>> changed;  // and what they were
    for (std::size_t at = 0; at < side.size(); ++at) {
      if (matcher.isSolidAt(touched[side[at]]) != too_many || rim[at] || !matcher.mayChange(side[at], its.below)) continue;
      std::uint8_t& voxel = voxels[touched[side[at]]];
      changed.emplace_back(touched[side[at]], voxel);
      voxel = too_many ? kEmpty : kKept;
    }
    if (too_many && side.size() >= kFlat && changed.size() < side.size()) {
      for (const auto& [index, was] : changed) voxels[index] = was;
      continue;
    }
    body += static_cast<double>(changed.size()) * change;
    all += static_cast<double>(changed.size()) * change;
  }
}

}  // namespace kelp::bake

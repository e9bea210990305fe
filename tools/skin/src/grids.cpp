// SPDX-License-Identifier: MIT
// Boxes of voxels for parts: what each owns, and what it shares with its neighbours.
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "share.h"

namespace kelp::bake {
namespace {

using PartPair = std::pair<std::uint32_t, std::uint32_t>;

struct Box {
  glm::ivec3 low{0x7fffffff}, high{-1};  // both included
  glm::ivec3 size() const { return high - low + 1; }
};

// Finds the voxels that parts share.
class Overlap {
 public:
  Overlap(const SkinSamples& samples, const SkinSpace& space, const std::vector<Seam>& seams,
          const std::vector<double>& overlaps, const VoxelOwners& owners, const VoxelGrid& whole)
      : owners_(owners), whole_(whole) {
    for (std::size_t s = 0; s < seams.size(); ++s) {
      Reach& reach = reaches_[{seams[s].a, seams[s].b}];
      reach.length = overlaps[s];
      for (const std::uint32_t e : seams[s].edges)
        reach.seam.push_back(0.5 * space.voxels *
                             (samples.positions[samples.edges[e].a] + samples.positions[samples.edges[e].b]));
    }
  }

  // The other parts' voxels that `part` has too: those within reach of the seam, through the solid.
  std::vector<std::uint64_t> voxelsOf(std::uint32_t part, const std::vector<std::uint64_t>& own) const {
    std::map<std::uint64_t, double> distances;
    using Entry = std::pair<double, std::uint64_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    const auto visit = [&](std::uint64_t from, double distance, bool start) {
      const glm::ivec3 at = place(from);
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const glm::ivec3 to = at + glm::ivec3(x, y, z);
            if ((x | y | z) == 0 || !isInside(to)) continue;
            const std::uint64_t index = fullIndex(to);
            const std::uint32_t other = owners_.owner[index];
            if (other == VoxelOwners::kEmpty || other == part) continue;
            const Reach* reach = reachTo(part, other);
            if (!reach) continue;
            const double depth = depthOf(index);
            const double next = distance + std::sqrt(static_cast<double>(x * x + y * y + z * z));
            if (next > std::max(reach->length, std::min(depth, reach->length + kDome))) continue;
            if (start && !isNearSeam(*reach, to, depth)) continue;
            const auto [entry, fresh] = distances.try_emplace(index, next);
            if (!fresh && entry->second <= next) continue;
            entry->second = next;
            open.emplace(next, index);
          }
    };
    for (const std::uint64_t index : own) visit(index, 0, true);
    while (!open.empty()) {
      const auto [distance, index] = open.top();
      open.pop();
      if (distances[index] < distance) continue;
      visit(index, distance, false);
    }
    std::vector<std::uint64_t> voxels;
    for (const auto& [index, distance] : distances) voxels.push_back(index);
    return voxels;
  }

 private:
  static constexpr double kDome = 4;  // voxels farther inside, where nobody sees them at rest
  struct Reach {
    double length = 0;
    std::vector<glm::dvec3> seam;
  };

  glm::ivec3 place(std::uint64_t index) const {
    const auto x = static_cast<std::uint64_t>(whole_.size.x), y = static_cast<std::uint64_t>(whole_.size.y);
    return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
  }
  bool isInside(const glm::ivec3& v) const {
    return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, whole_.size));
  }
  std::uint64_t fullIndex(const glm::ivec3& v) const { return denseIndex(whole_.size, v); }
  double depthOf(std::uint64_t index) const {
    const glm::ivec3 surface = place(whole_.surface[owners_.surface[index]].index);
    return glm::distance(glm::dvec3(surface), glm::dvec3(place(index)));
  }
  const Reach* reachTo(std::uint32_t a, std::uint32_t b) const {
    const auto found = reaches_.find({std::min(a, b), std::max(a, b)});
    return found == reaches_.end() ? nullptr : &found->second;
  }
  // Parts may also touch where they have nothing to do with each other: a hand at a leg.
  static bool isNearSeam(const Reach& reach, const glm::ivec3& at, double depth) {
    constexpr double kNear = 4;
    const double within = depth + kNear;
    return std::any_of(reach.seam.begin(), reach.seam.end(), [&](const glm::dvec3& seam) {
      const glm::dvec3 from = seam - (glm::dvec3(at) + 0.5);
      return glm::dot(from, from) <= within * within;
    });
  }

  const VoxelOwners& owners_;
  const VoxelGrid& whole_;
  std::map<PartPair, Reach> reaches_;
};

// Away from the solid around a voxel. Zero if it is as solid on all sides.
glm::vec3 openDirection(const fields::Occupancy& occupancy, const glm::ivec3& at) {
  constexpr int kFar = 2;
  glm::vec3 sum(0);
  for (int z = -kFar; z <= kFar; ++z)
    for (int y = -kFar; y <= kFar; ++y)
      for (int x = -kFar; x <= kFar; ++x) {
        const glm::ivec3 to = at + glm::ivec3(x, y, z);
        const bool inside = glm::all(glm::greaterThanEqual(to, glm::ivec3(0))) &&
                            glm::all(glm::lessThan(to, occupancy.size));
        if (!inside || !occupancy.solid[occupancy.index(to)]) sum += glm::vec3(x, y, z);
      }
  const float length = glm::length(sum);
  return length > 0 ? sum / length : glm::vec3(0);
}

// The voxels `list` of the whole grid as a grid of their own.
VoxelGrid gridOf(const std::vector<std::uint64_t>& list, const VoxelOwners& owners, const VoxelGrid& whole,
                 int threads) {
  const auto place = [](const glm::ivec3& size, std::uint64_t index) {
    const auto x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
    return glm::ivec3(static_cast<int>(index % x), static_cast<int>(index / x % y),
                      static_cast<int>(index / x / y));
  };
  Box box;
  for (const std::uint64_t index : list) {
    box.low = glm::min(box.low, place(whole.size, index));
    box.high = glm::max(box.high, place(whole.size, index));
  }
  fields::Occupancy occupancy{box.size(), std::vector<std::uint8_t>(denseCount(box.size()), 0)};
  for (const std::uint64_t index : list)
    occupancy.solid[occupancy.index(place(whole.size, index) - box.low)] = 1;
  VoxelGrid grid;
  grid.size = box.size();
  const glm::dmat4x3 to_node(whole.to_node);
  grid.to_node = whole.to_node;
  grid.to_node[3] = glm::vec3(to_node * glm::dvec4(glm::dvec3(box.low), 1));
  for (const std::uint64_t index : fields::surfaceVoxels(occupancy, threads)) {
    const glm::ivec3 at = place(grid.size, index);
    const std::uint64_t in_whole = denseIndex(whole.size, at + box.low);
    SurfaceSample sample = whole.surface[owners.surface[in_whole]];
    if (sample.index != in_whole) {
      const glm::vec3 open = openDirection(occupancy, at);
      if (open != glm::vec3(0)) sample.normal = open;
    }
    sample.index = index;
    grid.surface.push_back(sample);
  }
  grid.solid = std::move(occupancy.solid);
  return grid;
}

}  // namespace

std::vector<VoxelGrid> cutGrids(const SkinSamples& samples, const SkinSpace& space,
                                const std::vector<Seam>& seams, const std::vector<double>& overlaps,
                                const VoxelOwners& owners, const VoxelGrid& whole, int threads) {
  const Overlap overlap(samples, space, seams, overlaps, owners, whole);
  std::vector<std::vector<std::uint64_t>> lists(owners.counts.size());
  for (std::uint64_t i = 0; i < owners.owner.size(); ++i)
    if (owners.owner[i] != VoxelOwners::kEmpty) lists[owners.owner[i]].push_back(i);
  std::vector<VoxelGrid> grids;
  for (std::uint32_t part = 0; part < lists.size(); ++part) {
    const std::vector<std::uint64_t> shared = overlap.voxelsOf(part, lists[part]);
    std::vector<std::uint64_t> list = std::move(lists[part]);
    list.insert(list.end(), shared.begin(), shared.end());
    grids.push_back(gridOf(list, owners, whole, threads));
  }
  return grids;
}

}  // namespace kelp::bake

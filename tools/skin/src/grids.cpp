// SPDX-License-Identifier: MIT
// Boxes of voxels for parts: what each owns, and what it shares with its neighbors.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <unordered_map>
#include <utility>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "share.h"
#include "straight_grid.h"

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
  Overlap(const std::vector<SeamSteps>& seams, const SkinSpace& space, const VoxelOwners& owners,
          const VoxelGrid& whole, int threads)
      : most_(kMost * std::max(1.0, space.voxels)),
        owners_(owners),
        whole_(whole),
        outside_(whole.solid.size()) {
    fields::squaredDistance(whole.solid, whole.size, outside_, threads);
    for (const SeamSteps& seam : seams) seams_[{seam.a, seam.b}] = &seam;
  }

  // The other parts' voxels that `part` has too: those within reach of the seam, through the solid.
  // Ascending.
  std::vector<std::uint64_t> voxelsOf(std::uint32_t part, const std::vector<std::uint64_t>& own) const {
    Search search{part, {}, {}};
    for (const std::uint64_t index : own) visit(search, index, 0, index);
    while (!search.open.empty()) {
      const auto [distance, index] = search.open.top();
      search.open.pop();
      const Candidate& its = search.candidates.at(index);
      if (its.distance >= distance) visit(search, index, distance, its.origin);
    }
    std::vector<std::uint64_t> voxels;
    for (const auto& [index, candidate] : search.candidates)
      if (candidate.distance < kFar) voxels.push_back(index);
    std::sort(voxels.begin(), voxels.end());
    return voxels;
  }

 private:
  static constexpr double kShare = 0.5;  // of what opens, by each of the two
  static constexpr double kMore = 1;     // voxels; of those that stand out by as much as the edge: kMoreOut
  static constexpr double kMoreOut = 0.3;
  static constexpr double kMost = 5;  // units of the skin
  static constexpr float kFar = 1e9f;
  // Another part's voxel near the own ones.
  struct Candidate {
    float distance = kFar;     // from the own voxels, through those that are shared; kFar: not shared
    std::uint64_t origin = 0;  // the own voxel from which it was reached
    double reach = 0;          // how far from the own voxels it may be
    bool is_near = false;      // at the seam
    const std::vector<glm::dmat4x3>* steps = nullptr;  // what the part does there, seen from the other
  };
  // Dijkstra's.
  struct Search {
    std::uint32_t part;
    std::unordered_map<std::uint64_t, Candidate> candidates;
    using Entry = std::pair<float, std::uint64_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  };

  void visit(Search& search, std::uint64_t from, float distance, std::uint64_t origin) const {
    const glm::ivec3 at = voxelAt(whole_.size, from);
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const glm::ivec3 to = at + glm::ivec3(x, y, z);
          if (glm::clamp(to, glm::ivec3(0), whole_.size - 1) != to) continue;
          const std::uint64_t index = denseIndex(whole_.size, to);
          const std::uint32_t other = owners_.owner[index];
          if (other == VoxelOwners::kEmpty || other == search.part) continue;
          const auto seam = seams_.find(std::minmax(search.part, other));
          if (seam == seams_.end()) continue;
          const auto [entry, fresh] = search.candidates.try_emplace(index);
          Candidate& candidate = entry->second;
          if (fresh) judge(*seam->second, search.part, to, index, candidate);
          const float next = distance + std::sqrt(static_cast<float>(x * x + y * y + z * z));
          if (next >= candidate.distance || static_cast<double>(next) > candidate.reach ||
              (from == origin && !candidate.is_near) || standsOut(candidate, next, to, origin))
            continue;
          candidate.distance = next;
          candidate.origin = origin;
          search.open.emplace(next, index);
        }
  }
  void judge(const SeamSteps& seam, std::uint32_t part, const glm::ivec3& at, std::uint64_t index,
             Candidate& candidate) const {
    // Parts may also touch where they have nothing to do with each other: a hand at a leg.
    constexpr double kNear = 4;
    const glm::dvec3 center = glm::dvec3(at) + 0.5;
    const SeamSteps::Place& place = seam.nearest(center);
    const glm::ivec3 surface = voxelAt(whole_.size, whole_.surface[owners_.surface[index]].index);
    candidate.is_near =
        glm::distance(place.at, center) <= kNear + glm::distance(glm::dvec3(surface), glm::dvec3(at));
    candidate.reach = std::min(kShare * seam.opening(place, center), most_) + kMore;
    candidate.steps = &(part == seam.a ? seam.steps : seam.back_steps)[place.motion];
  }
  // True if the part moves a voxel of its neighbor out of the solid, as the neighbor sees it. Where the voxel
  // closes a gap, it may stand out as far as the part's own voxel from which it was reached.
  bool standsOut(const Candidate& candidate, float distance, const glm::ivec3& at,
                 std::uint64_t origin) const {
    const bool closes = static_cast<double>(distance) <= candidate.reach - kMore + kMoreOut;
    const glm::dvec4 center(glm::dvec3(at) + 0.5, 1), own(glm::dvec3(voxelAt(whole_.size, origin)) + 0.5, 1);
    return std::any_of(candidate.steps->begin(), candidate.steps->end(), [&](const glm::dmat4x3& step) {
      const double its = outside(step * center);
      return its > 0 && !(closes && its <= outside(step * own));
    });
  }
  // How far a place is from the solid.
  double outside(const glm::dvec3& at) const {
    const glm::dvec3 cell = glm::floor(at),
                     inner = glm::clamp(cell, glm::dvec3(0), glm::dvec3(whole_.size - 1));
    return std::sqrt(static_cast<double>(outside_[denseIndex(whole_.size, glm::ivec3(inner))])) +
           glm::distance(cell, inner);
  }

  double most_;  // voxels
  const VoxelOwners& owners_;
  const VoxelGrid& whole_;
  std::vector<std::uint32_t> outside_;  // squared distances to the solid
  std::map<PartPair, const SeamSteps*> seams_;
};

// The voxels `list` of the whole grid as a grid of their own.
VoxelGrid gridOf(const std::vector<std::uint64_t>& list, const VoxelOwners& owners, const VoxelGrid& whole) {
  Box box;
  for (const std::uint64_t index : list) {
    box.low = glm::min(box.low, voxelAt(whole.size, index));
    box.high = glm::max(box.high, voxelAt(whole.size, index));
  }
  fields::Occupancy occupancy{box.size(), std::vector<std::uint8_t>(denseCount(box.size()), 0)};
  for (const std::uint64_t index : list)
    occupancy.solid[occupancy.index(voxelAt(whole.size, index) - box.low)] = 1;
  VoxelGrid grid;
  grid.size = box.size();
  const glm::dmat4x3 to_node(whole.to_node);
  grid.to_node = whole.to_node;
  grid.to_node[3] = glm::vec3(to_node * glm::dvec4(glm::dvec3(box.low), 1));
  for (const std::uint64_t index : fields::surfaceVoxels(occupancy, 1)) {
    const glm::ivec3 at = voxelAt(grid.size, index);
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

std::vector<VoxelGrid> cutGrids(const SkinSpace& space, const PartTree& tree,
                                const std::vector<SeamSteps>& seams, const VoxelOwners& owners,
                                const VoxelGrid& whole, const MeshSurface* surface, int threads) {
  const Overlap overlap(seams, space, owners, whole, threads);
  std::vector<std::vector<std::uint64_t>> lists(owners.counts.size());
  for (std::uint64_t i = 0; i < owners.owner.size(); ++i)
    if (owners.owner[i] != VoxelOwners::kEmpty) lists[owners.owner[i]].push_back(i);
  std::vector<VoxelGrid> grids(lists.size());
  parallelRanges(lists.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      std::vector<std::uint64_t>& list = lists[part];
      const std::vector<std::uint64_t> shared = overlap.voxelsOf(static_cast<std::uint32_t>(part), list);
      list.insert(list.end(), shared.begin(), shared.end());
      if (!tree.sweeps[part]) grids[part] = gridOf(list, owners, whole);
    }
  });
  for (std::size_t part = 0; part < lists.size(); ++part)
    if (tree.sweeps[part])
      grids[part] = straightGrid(*tree.sweeps[part], space, *surface, lists[part], owners, whole, threads);
  return grids;
}

}  // namespace kelp::bake

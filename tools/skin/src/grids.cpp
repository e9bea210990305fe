// SPDX-License-Identifier: MIT
// Boxes of voxels for parts: what each owns, and what it shares with its neighbours.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <utility>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "rigid.h"
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
  Overlap(const SkinSamples& samples, const SkinSpace& space, const std::vector<Seam>& seams,
          const std::vector<double>& overlaps, const std::vector<SeamMotion>& motions,
          const VoxelOwners& owners, const VoxelGrid& whole)
      : owners_(owners), whole_(whole) {
    for (std::size_t s = 0; s < seams.size(); ++s) {
      Reach& reach = reaches_[{seams[s].a, seams[s].b}];
      reach.length = overlaps[s];
      for (std::size_t t = 0; t < motions[s].a.size(); ++t) {
        glm::dmat4x3 step = compose(inverseRigid(motions[s].b[t]), motions[s].a[t]);
        step[3] *= space.voxels;
        reach.steps.push_back(step);
        reach.back_steps.push_back(inverseRigid(step));
      }
      for (const std::uint32_t e : seams[s].edges)
        reach.seam.push_back(0.5 * space.voxels *
                             (samples.positions[samples.edges[e].a] + samples.positions[samples.edges[e].b]));
    }
  }

  // The other parts' voxels that `part` has too: those within reach of the seam, through the solid.
  // Ascending.
  std::vector<std::uint64_t> voxelsOf(std::uint32_t part, const std::vector<std::uint64_t>& own) const {
    Search search(part, boxAround(own));
    for (const std::uint64_t index : own) visit(search, voxelAt(whole_.size, index), 0, true);
    while (!search.open.empty()) {
      const auto [distance, index] = search.open.top();
      search.open.pop();
      if (search.distances[index] < distance) continue;
      visit(search, search.box.low + voxelAt(search.size, index), distance, false);
    }
    std::vector<std::uint64_t> voxels;
    for (std::size_t i = 0; i < search.distances.size(); ++i)
      if (search.distances[i] < kFar) voxels.push_back(fullIndex(search.box.low + voxelAt(search.size, i)));
    return voxels;
  }

 private:
  static constexpr double kDome = 2;  // voxels farther inside, where nobody sees them at rest
  static constexpr float kFar = 1e9f;
  // Dijkstra's, in a box around the part's own voxels.
  struct Search {
    std::uint32_t part;
    Box box;
    glm::ivec3 size;
    std::vector<float> distances;       // from the part's own voxels; kFar: not reached
    std::vector<std::uint8_t> answers;  // whether the part may have a voxel, where that is known
    using Entry = std::pair<float, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    Search(std::uint32_t its_part, const Box& its_box)
        : part(its_part),
          box(its_box),
          size(box.size()),
          distances(denseCount(size), kFar),
          answers(denseCount(size), kUnknown) {}
  };
  enum Answer : std::uint8_t { kUnknown, kFarFromSeam, kMay, kMayNot };
  struct Reach {
    double length = 0;
    std::vector<glm::dvec3> seam;
    // What the first part does, seen from the second, at each moment; and the other way round.
    std::vector<glm::dmat4x3> steps, back_steps;
  };

  // Whether the part moves a voxel of its neighbour out of the solid, as the neighbour sees it.
  bool sticksOut(const Reach& reach, bool is_first, const glm::ivec3& at) const {
    const glm::dvec4 centre(glm::dvec3(at) + 0.5, 1);
    const glm::dvec3 most = glm::dvec3(whole_.size - 1);
    const auto& steps = is_first ? reach.steps : reach.back_steps;
    return std::any_of(steps.begin(), steps.end(), [&](const glm::dmat4x3& step) {
      const glm::dvec3 moved = glm::floor(step * centre);
      return glm::clamp(moved, glm::dvec3(0), most) != moved || !whole_.solid[fullIndex(glm::ivec3(moved))];
    });
  }

  void visit(Search& search, const glm::ivec3& at, float distance, bool start) const {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const glm::ivec3 to = at + glm::ivec3(x, y, z);
          if ((x | y | z) == 0 || glm::any(glm::lessThan(to, search.box.low)) ||
              glm::any(glm::greaterThan(to, search.box.high)))
            continue;
          const std::uint64_t index = fullIndex(to);
          const std::uint32_t other = owners_.owner[index];
          if (other == VoxelOwners::kEmpty || other == search.part) continue;
          const std::size_t local = denseIndex(search.size, to - search.box.low);
          const float next = distance + std::sqrt(static_cast<float>(x * x + y * y + z * z));
          if (next >= search.distances[local]) continue;
          const Reach* reach = reachTo(search.part, other);
          if (!reach) continue;
          const double depth = depthOf(index);
          if (static_cast<double>(next) > std::max(reach->length, std::min(depth, reach->length + kDome)))
            continue;
          std::uint8_t& answer = search.answers[local];
          if (answer == kMayNot || (start && answer == kFarFromSeam)) continue;
          if (start && answer == kUnknown && !isNearSeam(*reach, to, depth)) {
            answer = kFarFromSeam;
            continue;
          }
          if (answer != kMay) answer = sticksOut(*reach, search.part < other, to) ? kMayNot : kMay;
          if (answer == kMayNot) continue;
          search.distances[local] = next;
          search.open.emplace(next, local);
        }
  }
  Box boxAround(const std::vector<std::uint64_t>& own) const {
    Box box;
    for (const std::uint64_t index : own) {
      box.low = glm::min(box.low, voxelAt(whole_.size, index));
      box.high = glm::max(box.high, voxelAt(whole_.size, index));
    }
    double most = 0;
    for (const auto& [pair, reach] : reaches_) most = std::max(most, reach.length);
    const int more = static_cast<int>(std::ceil(most + kDome)) + 1;
    box.low = glm::max(box.low - more, glm::ivec3(0));
    box.high = glm::min(box.high + more, whole_.size - 1);
    return box;
  }
  std::uint64_t fullIndex(const glm::ivec3& v) const { return denseIndex(whole_.size, v); }
  double depthOf(std::uint64_t index) const {
    const glm::ivec3 surface = voxelAt(whole_.size, whole_.surface[owners_.surface[index]].index);
    return glm::distance(glm::dvec3(surface), glm::dvec3(voxelAt(whole_.size, index)));
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

std::vector<VoxelGrid> cutGrids(const SkinSamples& samples, const SkinSpace& space, const PartTree& tree,
                                const std::vector<Seam>& seams, const std::vector<double>& overlaps,
                                const std::vector<SeamMotion>& motions, const VoxelOwners& owners,
                                const VoxelGrid& whole, const MeshSurface* surface, int threads) {
  const Overlap overlap(samples, space, seams, overlaps, motions, owners, whole);
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

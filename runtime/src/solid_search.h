// SPDX-License-Identifier: MIT
// A search through the solid of one part: the voxels of the levels of distances are a tree, each one's place
// is bounded as the pose bends it, and the most promising one is looked at first.
#pragma once

#include <algorithm>

#include "asset_impl.h"
#include "kelp/formats/distance.h"
#include "kelp/runtime/level.h"
#include "posed_solid.h"
#include "rest_distance.h"

namespace kelp::runtime {

// A box about something bent, in the frame of the search.
struct FrameBox {
  glm::dvec3 center{0}, half{0};
};

// A search sees the world from `eye`, turned so that the part's axes are the frame's, if they are
// perpendicular; then boxes fit best. Lengths are those of the world.
struct SearchFrame {
  SearchFrame(const SolidPlace& solid, const glm::dvec3& eye);

  FrameBox place(const glm::dvec3& low, const glm::dvec3& high) const {
    const glm::dvec3 half = 0.5 * (high - low);
    return {to_frame * (0.5 * (low + high)) + offset, grow * half};
  }
  glm::dvec3 place(const glm::dvec3& p) const { return to_frame * p + offset; }
  glm::dvec3 turn(const glm::dvec3& world) const { return from_world * world; }
  glm::dvec3 toWorld(const glm::dvec3& p) const { return glm::transpose(from_world) * p + eye; }

  glm::dvec3 eye{0};
  glm::dmat3 from_world{1};  // a rotation
  glm::dmat3 to_frame{1};    // of part space
  glm::dmat3 grow{1};        // its absolute values, and a little for rounding
  glm::dvec3 offset{0};
  bool shears = true;  // the part's axes are not perpendicular
};

// Contains a voxel (low to high at rest) between two cuts in ascending order, deformed.
FrameBox boxOf(const SearchFrame& frame, const SplineMap& map, const SplineMap::Cut& from,
               const SplineMap::Cut& to, const glm::dvec3& low, const glm::dvec3& high);
FrameBox boxOf(const SearchFrame& frame, const SweepMap& map, const SweepMap::Cut& from,
               const SweepMap::Cut& to, const glm::dvec3& low, const glm::dvec3& high);

// The leaf of a search: a voxel between two cuts.
template <class Map>
struct SearchLeaf {
  glm::dvec3 low{0}, high{0};  // the voxel at rest, level-0 voxels
  const typename Map::Cut* from = nullptr;
  const typename Map::Cut* to = nullptr;
};

// Without initial values, as many are on the stack.
template <class Map>
struct SearchNode {
  int level;  // of its voxel
  glm::ivec3 voxel;
  typename Map::Cut from, to;  // its lowest and its highest
  double key;
};

inline constexpr int kMostSearchNodes = 1 << 15;

// Goes through the part's solid voxels. goal.key(box): a lower bound of what is sought for all that is in the
// box; goal.limit(): boxes with such a key or a greater one are of no interest; goal.visit(leaf, key);
// goal.giveUp(key): the search was too long, and what it has not seen has no lesser key.
template <class Map, class Goal>
class SolidSearch {
 public:
  SolidSearch(const PosedSolid<Map>& solid, const SearchFrame& frame, Goal& goal)
      : solid_(solid), frame_(frame), goal_(goal) {}

  void run() {
    for (int l = std::min(DistanceReader::levels(*solid_.asset, solid_.part), kMaxLevels) - 1; l >= 0; --l) {
      levels_[l] = DistanceReader::level(*solid_.asset, solid_.part, l);
      if (levels_[l]) finest_ = l;
    }
    int root = 0;
    while ((1 << root) < std::max({solid_.size.x, solid_.size.y, solid_.size.z})) ++root;
    add({root, glm::ivec3(0), solid_.map.cutOfRest(0), solid_.map.cutOfRest(solid_.size.y), 0});
    for (int visited = 0; count_ > 0; ++visited) {
      const Node node = stack_[--count_];
      if (!(node.key < goal_.limit())) continue;
      if (visited == kMostSearchNodes) {
        double least = node.key;
        while (count_ > 0) least = std::min(least, stack_[--count_].key);
        return goal_.giveUp(least);
      }
      if (node.level > finest_)
        descend(node);
      else
        split(node);
    }
  }

 private:
  using Node = SearchNode<Map>;
  using Cut = typename Map::Cut;
  // A node makes room for at most eight; below the levels, for two.
  static constexpr int kStack = 7 * (kMaxLevels + 1) + 64;

  glm::dvec3 low(const Node& node) const {
    return static_cast<double>(1 << node.level) * glm::dvec3(node.voxel);
  }
  glm::dvec3 high(const Node& node) const {
    return glm::min(static_cast<double>(1 << node.level) * glm::dvec3(node.voxel + 1),
                    glm::dvec3(solid_.size));
  }
  // Adds a node behind those of its siblings (from `begin` on) that are less promising.
  void add(Node node, int begin = 0) {
    node.key = goal_.key(boxOf(frame_, solid_.map, node.from, node.to, low(node), high(node)));
    if (!(node.key < goal_.limit())) return;
    int at = count_++;
    for (; at > begin && stack_[at - 1].key < node.key; --at) stack_[at] = stack_[at - 1];
    stack_[at] = node;
  }
  void descend(const Node& node) {
    const int level = node.level - 1, begin = count_;
    const Level* known = levels_[level];  // null: not in memory, so anything may be solid
    const glm::ivec3 first = 2 * node.voxel;
    const double middle_y = static_cast<double>(1 << level) * (first.y + 1);
    const glm::ivec3 end = levelSize(solid_.size, level);
    const bool two = middle_y < solid_.size.y;
    const Cut middle = two ? solid_.map.cutOfRest(middle_y) : node.to;
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 voxel = first + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      if (voxel.x >= end.x || voxel.y >= end.y || voxel.z >= end.z ||
          (known && !isInside(distanceCode(*known, voxel))))
        continue;
      const bool upper = voxel.y > first.y;
      add({level, voxel, upper ? middle : node.from, upper ? node.to : middle, 0}, begin);
    }
  }
  // A voxel of the finest level: cuts it until its box tells enough.
  void split(const Node& node) {
    const double side = static_cast<double>(1 << node.level);
    const glm::dvec3 least = low(node), most = high(node);
    Cut middle;
    if (count_ + 2 > kStack || solid_.map.isFine(node.from, node.to, least, most, side) ||
        !solid_.map.between(node.from, node.to, middle))
      return goal_.visit(SearchLeaf<Map>{least, most, &node.from, &node.to}, node.key);
    const int begin = count_;
    add({node.level, node.voxel, node.from, middle, 0}, begin);
    add({node.level, node.voxel, middle, node.to, 0}, begin);
  }

  const PosedSolid<Map>& solid_;
  const SearchFrame& frame_;
  Goal& goal_;
  const Level* levels_[kMaxLevels + 1] = {};
  int finest_ = 0;
  Node stack_[kStack];
  int count_ = 0;
};

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// SolidSearch, of a part with cages: down the tree of boxes to the cells, then in each tetrahedron down the
// levels of distances to solid voxels, then on in parts of these until boxes are about as large as a voxel.
#pragma once

#include <bit>

#include "../solid_search.h"
#include "cage_map.h"

namespace kelp::runtime {

// Solid: what lies in a tetrahedron of a box at rest.
struct CageLeaf {
  const PosedTetrahedron& map;
  glm::dvec3 low{0}, high{0};
};
// True if a box at rest has points in a tetrahedron.
inline bool meets(const PosedTetrahedron& t, const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 least = low - t.rest, most = high - t.rest;
  const auto [a, b, c] = t.kind->axes;
  return most[a] >= least[b] && most[b] >= least[c] && most[a] >= least[c];
}
// The point at rest of a leaf that is nearest to the frame's origin, which is `eye` in part space: along one
// axis after the other, each time to the nearest point.
inline glm::dvec3 nearestOf(const CageLeaf& leaf, const SearchFrame& frame, const glm::dvec3& eye) {
  const auto [a, b, c] = leaf.map.kind->axes;
  const glm::dvec3 &rest = leaf.map.rest, low = leaf.low - rest, high = leaf.high - rest;
  const glm::dmat3 to_frame = frame.to_frame * leaf.map.gradient;
  const glm::dvec3 q = leaf.map.toRest(eye) - rest;
  glm::dvec3 p;  // p[a] >= p[b] >= p[c]
  p[c] = std::clamp(q[c], low[c], std::min({high[a], high[b], high[c]}));
  p[b] = std::clamp(q[b], std::max(low[b], p[c]), std::min(high[a], high[b]));
  p[a] = std::clamp(q[a], std::max(low[a], p[b]), high[a]);
  glm::dvec3 at = frame.place(leaf.map.place(rest + p));
  const auto move = [&](int axis, double least, double most) {
    const glm::dvec3& along = to_frame[axis];
    const double to = std::clamp(p[axis] - glm::dot(along, at) / glm::dot(along, along), least, most);
    at += (to - p[axis]) * along;
    p[axis] = to;
  };
  constexpr int kSweeps = 8;
  for (int i = 0; i < kSweeps; ++i) {
    move(a, std::max(low[a], p[b]), high[a]);
    move(b, std::max(low[b], p[c]), std::min(high[b], p[a]));
    move(c, low[c], std::min(high[c], p[b]));
  }
  return rest + p;
}

// A box of the tree, or a box at rest in a tetrahedron of a cell.
struct CageSearchNode {
  double key;
  std::uint32_t index;   // of the box, or of the cell
  int number;            // of the tetrahedron; -1: a box of the tree
  int level;             // of the voxel that the box is; -1: it is solid, and no voxel
  glm::dvec3 low, high;  // at rest
};

template <class Goal>
class CageSearch {
 public:
  CageSearch(const CagedSolid& solid, const SearchFrame& frame, Goal& goal)
      : solid_(solid), cage_(*solid.cage.cage), frame_(frame), goal_(goal) {}

  void run() {
    for (int l = std::min(DistanceReader::levels(*solid_.asset, solid_.part), kMaxLevels) - 1; l >= 0; --l) {
      levels_[l] = DistanceReader::level(*solid_.asset, solid_.part, l);
      if (levels_[l]) finest_ = l;
    }
    for (int i = 0; i < 3; ++i) voxel_ = std::max(voxel_, glm::length(solid_.to_world[i]) * (1 << finest_));
    addBox(1, 0);
    for (int visited = 0; count_ > 0; ++visited) {
      const CageSearchNode node = stack_[--count_];
      if (!(node.key < goal_.limit())) continue;
      if (visited == kMostSearchNodes) {
        double least = node.key;
        while (count_ > 0) least = std::min(least, stack_[--count_].key);
        return goal_.giveUp(least);
      }
      if (node.number < 0) {
        openBox(node.index);
      } else {
        const PosedTetrahedron t = tetrahedronOf(solid_.cage, node.index, node.number);
        openVoxel(node, t);
      }
    }
  }

 private:
  static constexpr double kFine = 0.5;            // half of a box as it should be, in voxels
  static constexpr double kLeastPart = 1.0 / 16;  // of a voxel: where splitting ends
  // The tree has at most 28 levels and adds one box at each; a leaf adds kLeafCells cells of six tetrahedra,
  // each with two faces into the inside; below these boxes are halved at most 8 times.
  static constexpr int kStack = 28 + 18 * static_cast<int>(kLeafCells) + 7 * 8 + 8;

  // Behind the siblings, from `begin` on, that are less promising.
  void push(const CageSearchNode& node, int begin) {
    if (!(node.key < goal_.limit())) return;
    int at = count_++;
    for (; at > begin && stack_[at - 1].key < node.key; --at) stack_[at] = stack_[at - 1];
    stack_[at] = node;
  }
  void addBox(std::uint32_t box, int begin) {
    const Box& of = solid_.cage.tree[box];
    if (of.min.x == kNowhere) return;
    const double key = goal_.key(frame_.place(glm::dvec3(of.min), glm::dvec3(of.max)));
    push({key, box, -1, 0, {}, {}}, begin);
  }
  FrameBox place(const PosedTetrahedron& t, const glm::dvec3& low, const glm::dvec3& high) const {
    const glm::dmat3 to_frame = frame_.to_frame * t.gradient;
    const glm::dvec3 half = 0.5 * (high - low);
    return {frame_.place(t.place(0.5 * (low + high))),
            (1 + 1e-9) * (glm::abs(to_frame[0]) * half.x + glm::abs(to_frame[1]) * half.y +
                          glm::abs(to_frame[2]) * half.z) +
                1e-9 * voxel_};
  }
  void add(const PosedTetrahedron& t, CageSearchNode node, int begin) {
    if (!meets(t, node.low, node.high)) return;
    node.key = goal_.key(place(t, node.low, node.high));
    push(node, begin);
  }

  void openBox(std::uint32_t box) {
    const int begin = count_;
    if (box < solid_.cage.leaves) {
      addBox(2 * box, begin);
      addBox(2 * box + 1, begin);
      return;
    }
    for (const std::uint32_t cell :
         cage_.leaves.subspan(kLeafCells * std::size_t{box - solid_.cage.leaves}, kLeafCells))
      if (cell != kCageOutside) openCell(cell, begin);
  }
  void openCell(std::uint32_t cell, int begin) {
    const glm::ivec3 corner = cage_.side * cage_.place(cell);
    const int level = std::countr_zero(static_cast<unsigned>(cage_.side));
    const glm::dvec3 low(corner), high = glm::min(low + double(cage_.side), glm::dvec3(solid_.size));
    for (int i = 0; i < 6; ++i) {
      const PosedTetrahedron t = tetrahedronOf(solid_.cage, cell, i);
      if (!(t.volume > 0)) continue;
      glm::dvec3 least(INFINITY), most(-INFINITY);
      for (const glm::dvec3& p : t.corners) {
        least = glm::min(least, frame_.place(p));
        most = glm::max(most, frame_.place(p));
      }
      const FrameBox box{0.5 * (least + most), 0.5 * (1 + 1e-9) * (most - least) + 1e-9 * voxel_};
      const double key = goal_.key(box);
      push({key, cell, i, level, low, high}, begin);
      for (const int face : {0, 3}) {
        const int side = cellFace(*t.kind, face);
        if (cage_.beyond(cell, side) != kCageInside) continue;
        CageSearchNode end{key, cell, i, -1, low, high};
        (side & 1 ? end.low : end.high)[side >> 1] = (side & 1 ? end.high : end.low)[side >> 1];
        push(end, begin);
      }
    }
  }
  void openVoxel(const CageSearchNode& node, const PosedTetrahedron& t) {
    if (node.level > finest_) return descend(node, t);
    const FrameBox box = place(t, node.low, node.high);
    const bool fine = std::max({box.half.x, box.half.y, box.half.z}) <= kFine * voxel_;
    const glm::dvec3 extent = node.high - node.low;
    const bool least = std::max({extent.x, extent.y, extent.z}) <= kLeastPart * (1 << finest_);
    if (fine || least || count_ + 8 > kStack) return goal_.visit(CageLeaf{t, node.low, node.high}, node.key);
    const int begin = count_;
    const glm::dvec3 middle = 0.5 * (node.low + node.high);
    for (int i = 0; i < 8; ++i) {
      CageSearchNode part = node;
      bool flat = false;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = (i >> axis & 1) != 0;
        flat |= upper && extent[axis] == 0;
        (upper ? part.low : part.high)[axis] = middle[axis];
      }
      if (!flat) add(t, part, begin);
    }
  }
  void descend(const CageSearchNode& node, const PosedTetrahedron& t) {
    const int level = node.level - 1, side = 1 << level, begin = count_;
    const Level* known = level < kMaxLevels ? levels_[level] : nullptr;  // null: anything may be solid
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 low = glm::ivec3(node.low) + side * glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      if (glm::any(glm::greaterThanEqual(low, solid_.size)) || !isOfPiece(cage_, node.index, low, side))
        continue;
      if (known && !isInside(distanceCode(*known, low >> level))) continue;
      const glm::dvec3 from(low), to = glm::min(from + double(side), glm::dvec3(solid_.size));
      add(t, {0, node.index, node.number, level, from, to}, begin);
    }
  }

  const CagedSolid& solid_;
  const Cage& cage_;
  const SearchFrame& frame_;
  Goal& goal_;
  const Level* levels_[kMaxLevels + 1] = {};
  int finest_ = 0;
  double voxel_ = 0;  // the longest side of a voxel of that level, in the world
  CageSearchNode stack_[kStack];
  int count_ = 0;
};

}  // namespace kelp::runtime

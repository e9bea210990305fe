// SPDX-License-Identifier: MIT
#include "kelp/cages/posed_cage.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/glm.hpp>

#include "../asset_impl.h"
#include "kelp/simd/lanes.h"
#include "pose_nodes.h"

namespace kelp::runtime {
namespace {

using simd::Lanes;

constexpr Error kOtherPose{ErrorCode::kMisuse, "the pose is of another asset"};

struct Lanes3 {
  Lanes x, y, z;
};
Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

glm::vec3 cornerOf(Lanes at) {
  float numbers[4];
  at.store(numbers);
  return {numbers[0], numbers[1], numbers[2]};
}

Box around(const Box& a, const Box& b) {
  Box both = a;
  both.min = glm::min(a.min, b.min);
  both.max = glm::max(a.max, b.max);
  return both;
}

// The tetrahedra of four cells, whose determinants are above 0 in lane i of `upright` at bit i: as in
// kCageTetrahedra. A determinant is a sum of products of one x, one y and one z each, none above `margin` /
// 2^-18. Float gets it right to 48 roundings of these.
struct FourCells {
  Lanes3 corner[8];
  Lanes3 low, high;
  unsigned upright[6];

  FourCells(const glm::vec3* nodes, const std::uint32_t* const (&cells)[4]) {
    [&]<int... kCorners>(std::integer_sequence<int, kCorners...>) { (load<kCorners>(nodes, cells), ...); }
    (std::make_integer_sequence<int, 8>());
    const Lanes3 extent = high - low;
    const Lanes margin = 0x1p-18f * (extent.x * extent.y * extent.z);
    const Lanes3 diagonal = corner[7] - corner[0];
    test<0>(diagonal, margin), test<2>(diagonal, margin), test<4>(diagonal, margin);
  }

 private:
  template <int kCorner>
  void load(const glm::vec3* nodes, const std::uint32_t* const (&cells)[4]) {
    const float* const places[4] = {
        &nodes[cageNode(cells[0], kCorner)].x, &nodes[cageNode(cells[1], kCorner)].x,
        &nodes[cageNode(cells[2], kCorner)].x, &nodes[cageNode(cells[3], kCorner)].x};
    Lanes3& at = corner[kCorner];
    Lanes unused;
    loadFours(places, 0, at.x, at.y, at.z, unused);
    low = kCorner == 0 ? at : Lanes3{min(at.x, low.x), min(at.y, low.y), min(at.z, low.z)};
    high = kCorner == 0 ? at : Lanes3{max(at.x, high.x), max(at.y, high.y), max(at.z, high.z)};
  }
  // Two tetrahedra that have the edge from corner 0 to corner 2^(k / 2) in common.
  template <int k>
  void test(const Lanes3& diagonal, Lanes margin) {
    const Lanes3 normal = cross(diagonal, corner[kCageTetrahedra[k].corners[1]] - corner[0]);
    const Lanes first = dot(corner[kCageTetrahedra[k].corners[2]] - corner[0], normal),
                second = dot(corner[kCageTetrahedra[k + 1].corners[2]] - corner[0], normal);
    // Permutations 0, 3 and 4 are even.
    upright[k] = lessBits(margin, k == 2 ? 0.0f - first : first);
    upright[k + 1] = lessBits(margin, k == 2 ? second : 0.0f - second);
  }
};

void addInverted(const FourCells& four, unsigned lanes, CageInPose& cage) {
  alignas(16) float corners[8][3][4];
  for (int i = 0; i < 8; ++i) {
    four.corner[i].x.store(corners[i][0]);
    four.corner[i].y.store(corners[i][1]);
    four.corner[i].z.store(corners[i][2]);
  }
  for (int t = 0; t < 6; ++t) {
    for (unsigned left = lanes & ~four.upright[t]; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      ++cage.inverted_count;
      for (const int i : kCageTetrahedra[t].corners)
        cage.inverted.add({corners[i][0][lane], corners[i][1][lane], corners[i][2][lane]});
    }
  }
}

// One float more is read after the last node.
Box boxAround(std::span<const glm::vec3> nodes) {
  Lanes low = INFINITY, high = -INFINITY;
  for (const glm::vec3& node : nodes) {
    const Lanes at = Lanes::load(&node.x);
    low = min(at, low);
    high = max(at, high);
  }
  return {cornerOf(low), cornerOf(high)};
}

// The box around all nodes, and the inverted tetrahedra.
void boundCells(const Cage& cage, CageInPose& posed) {
  posed.inverted = Box{};
  posed.inverted_count = 0;
  Lanes3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  const std::uint32_t count = cage.cells();
  for (std::uint32_t first = 0; first < count; first += 4) {
    const std::uint32_t* cells[4];
    for (std::uint32_t lane = 0; lane < 4; ++lane) cells[lane] = cage.cell(std::min(first + lane, count - 1));
    const FourCells four(posed.nodes, cells);
    const unsigned lanes = first + 4 > count ? (1u << (count - first)) - 1 : 15u;
    if (lanes & ~(four.upright[0] & four.upright[1] & four.upright[2] & four.upright[3] & four.upright[4] &
                  four.upright[5]))
      addInverted(four, lanes, posed);
    low = {min(four.low.x, low.x), min(four.low.y, low.y), min(four.low.z, low.z)};
    high = {max(four.high.x, high.x), max(four.high.y, high.y), max(four.high.z, high.z)};
  }
  Lanes none = low.x, more = high.x;
  transpose(low.x, low.y, low.z, none);
  transpose(high.x, high.y, high.z, more);
  const Lanes least = min(min(low.x, low.y), min(low.z, none));
  const Lanes most = max(max(high.x, high.y), max(high.z, more));
  posed.bounds = {cornerOf(least), cornerOf(most)};
}

// The tree, from its leaves up.
void growTree(const Cage& cage, const CageInPose& posed) {
  Box* const leaf = posed.tree + posed.leaves;
  for (std::size_t i = 0; i < posed.leaves; ++i) {
    Lanes low = INFINITY, high = -INFINITY;
    for (const std::uint32_t cell : cage.leaves.subspan(kLeafCells * i, kLeafCells)) {
      if (cell == kCageOutside) continue;
      for (int corner = 0; corner < 8; ++corner) {
        const Lanes at = Lanes::load(&posed.nodes[cage.node(cell, corner)].x);
        low = min(at, low);
        high = max(at, high);
      }
    }
    leaf[i] = {cornerOf(low), cornerOf(high)};
  }
  for (std::size_t i = posed.leaves - 1; i > 0; --i)
    posed.tree[i] = around(posed.tree[2 * i], posed.tree[2 * i + 1]);
  const glm::vec3 nowhere(kNowhere);
  for (Box& box : std::span(posed.tree, 2 * std::size_t{posed.leaves}).subspan(1))
    if (box.empty()) box = {nowhere, nowhere};
}

// Nodes of a coarser cage follow those of the next finer one.
void placeCoarser(const Pose& pose, int part, std::span<const Cage> cages, int cage) {
  if (cage == 0) return;
  CageInPose* const in = PoseCages::of(pose, part)->cages.data();
  in[cage].placed.make(PoseCages::of(pose, part)->placements, [&] {
    placeCoarser(pose, part, cages, cage - 1);
    const Cage &finer = cages[static_cast<std::size_t>(cage) - 1],
               &coarser = cages[static_cast<std::size_t>(cage)];
    const glm::vec3* const from = in[cage - 1].nodes;
    for (std::uint32_t i = 0; i < in[cage].node_count; ++i) {
      if (!(coarser.follows[i] & kFollowsAll)) {
        in[cage].nodes[i] = from[coarser.follows[i]];
        continue;
      }
      const CageFollow follow = cageFollows(coarser, i, finer);
      Lanes at = 0.0f;
      for (int k = 0; k < follow.count; ++k)
        at = at + follow.weights[k] * Lanes::load(&from[follow.nodes[k]].x);
      in[cage].nodes[i] = cornerOf(at);
    }
    return true;
  });
}

}  // namespace

Result<PosedCage> posedCage(const Instance& instance, int part, int cage, CageUse use) {
  if (!instance.asset || part < 0 || static_cast<std::size_t>(part) >= instance.asset->pack().parts().size())
    return Error{ErrorCode::kMisuse, "there is no such part"};
  const std::span<const Cage> cages = instance.asset->pack().parts()[static_cast<std::size_t>(part)].cages;
  if (cage < 0 || static_cast<std::size_t>(cage) >= cages.size())
    return Error{ErrorCode::kMisuse, "the part has no such cage"};
  const Cage& of = cages[static_cast<std::size_t>(cage)];
  const Result<const Pose*> posed = instance.pose ? instance.pose : RestPose::of(*instance.asset);
  if (!posed) return posed.error();
  const Pose& pose = **posed;
  NodesInPose* const nodes = PoseCages::of(pose, part);
  if (!nodes || nodes->cages.size() != cages.size()) return kOtherPose;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(cage); ++i) {
    if (nodes->cages[i].node_count != cages[i].nodes() || nodes->cages[i].cell_count != cages[i].cells())
      return kOtherPose;
  }
  if (nodes->influences.empty() != of.influences.empty() || nodes->morphs.size() != of.morphs.size() ||
      static_cast<std::size_t>(pose.parts()) != instance.asset->pack().parts().size())
    return kOtherPose;
  CageInPose& in = nodes->cages[static_cast<std::size_t>(cage)];
  const std::span<const glm::vec3> placed(in.nodes, in.node_count);
  if (nodes->followsParts()) {
    const Result<void> sound = PoseCages::check(pose, part);
    if (!sound) return sound.error();
    if (use == CageUse::kBounds)
      return PosedCage{&of, {}, PoseCages::followedBounds(pose, part), {}, 0, {}, in.leaves};
  } else if (!PoseCages::place(pose, part)) {
    return nodes->failure;
  }
  const std::uint64_t now = PoseCages::madeFor(pose, part);
  if (use == CageUse::kBounds && cage == 0 && !in.bounded.isMade(now)) {
    if (const Result<void> sound = PoseCages::check(pose, part); !sound) return sound.error();
    return PosedCage{&of, placed, boxAround(placed), {}, 0, {}, in.leaves};
  }
  const bool made = in.bounded.make(now, [&] {
    if (!PoseCages::check(pose, part)) return false;
    if (nodes->followsParts()) {
      in.placed.make(now, [&] {
        return PoseCages::follow(pose, part, {of.influences, of.morphs, of.places.data(), of.side}, in.nodes);
      });
    } else {
      placeCoarser(pose, part, cages, cage);
    }
    boundCells(of, in);
    return true;
  });
  if (!made) return PoseCages::check(pose, part).error();
  PosedCage posed_cage{&of,      {in.nodes, in.node_count}, in.bounds, in.inverted, in.inverted_count, {},
                       in.leaves};
  if (use != CageUse::kTree) return posed_cage;
  in.grown.make(now, [&] {
    growTree(of, in);
    return true;
  });
  posed_cage.tree = {in.tree, 2 * std::size_t{in.leaves}};
  return posed_cage;
}

}  // namespace kelp::runtime

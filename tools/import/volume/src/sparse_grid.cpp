// SPDX-License-Identifier: MIT
#include "sparse_grid.h"

#include <algorithm>
#include <cmath>

#include "kelp/common/dense_index.h"

namespace kelp::bake {
namespace {

bool before(const glm::ivec3& a, const glm::ivec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

glm::ivec3 alignedTo(const glm::ivec3& at, int side) { return at & glm::ivec3(~(side - 1)); }

// The cell of a node of 2^log2 cells a side, each 2^cell_log2 voxels.
std::size_t cellIn(const glm::ivec3& at, int log2, int cell_log2) {
  const int mask = (1 << log2) - 1;
  return static_cast<std::size_t>(
      (((at.x >> cell_log2 & mask) << log2 | (at.y >> cell_log2 & mask)) << log2) |
      (at.z >> cell_log2 & mask));
}

glm::ivec3 cellLow(const glm::ivec3& low, std::size_t cell, int log2, int cell_log2) {
  const int mask = (1 << log2) - 1, i = static_cast<int>(cell);
  return low +
         glm::ivec3((i >> 2 * log2) << cell_log2, (i >> log2 & mask) << cell_log2, (i & mask) << cell_log2);
}

bool bit(const std::vector<std::uint64_t>& bits, std::size_t i) { return bits[i / 64] >> (i % 64) & 1; }

}  // namespace

std::uint64_t SparseGrid::bytes() const {
  constexpr std::uint64_t kUpper =
      sizeof(Table) + (std::size_t{1} << 3 * kUpperLog2) * 4 + (std::size_t{1} << 3 * kUpperLog2) / 8;
  constexpr std::uint64_t kLower =
      sizeof(Table) + (std::size_t{1} << 3 * kLowerLog2) * 4 + (std::size_t{1} << 3 * kLowerLog2) / 8;
  return numbers.bytes() + roots.size() * sizeof(Root) + upper.size() * kUpper + lower.size() * kLower +
         leaves.size() * sizeof(Leaf);
}

SparseCell SparseSampler::cellAt(const glm::ivec3& at) const {
  const auto components = static_cast<std::size_t>(grid_.components);
  const auto inLeaf = [&](const SparseGrid::Leaf& leaf) {
    const std::size_t i = cellIn(at, SparseGrid::kLeafLog2, 0);
    return SparseCell{at, 1, (leaf.active[i / 64] >> (i % 64) & 1) != 0, leaf.first + i * components};
  };
  if (leaf_ != nullptr && alignedTo(at, SparseGrid::kLeafSide) == leaf_->low) return inLeaf(*leaf_);
  if (grid_.isDense()) {
    const bool inside =
        glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, grid_.dense));
    return {at, 1, inside, inside ? denseIndex(grid_.dense, at) : SparseCell::kBackground};
  }
  const glm::ivec3 root_low = alignedTo(at, SparseGrid::kUpperSide);
  const auto root =
      std::lower_bound(grid_.roots.begin(), grid_.roots.end(), root_low,
                       [](const SparseGrid::Root& r, const glm::ivec3& low) { return before(r.low, low); });
  if (root == grid_.roots.end() || root->low != root_low)
    return {root_low, SparseGrid::kUpperSide, false, SparseCell::kBackground};
  if (root->child < 0) return {root_low, SparseGrid::kUpperSide, root->active, root->first};
  const SparseGrid::Table& upper = grid_.upper[static_cast<std::size_t>(root->child)];
  const std::size_t i = cellIn(at, SparseGrid::kUpperLog2, 7);
  if (upper.child[i] < 0)
    return {alignedTo(at, SparseGrid::kLowerSide), SparseGrid::kLowerSide, bit(upper.active, i),
            upper.first + i * components};
  const SparseGrid::Table& lower = grid_.lower[static_cast<std::size_t>(upper.child[i])];
  const std::size_t j = cellIn(at, SparseGrid::kLowerLog2, 3);
  if (lower.child[j] < 0)
    return {alignedTo(at, SparseGrid::kLeafSide), SparseGrid::kLeafSide, bit(lower.active, j),
            lower.first + j * components};
  leaf_ = &grid_.leaves[static_cast<std::size_t>(lower.child[j])];
  return inLeaf(*leaf_);
}

double SparseSampler::between(const glm::dvec3& point) const {
  if (!onLattice(point)) return grid_.background[0];
  // On a voxel's centre, up to rounding: its own value, so that one equal to the isovalue stays so.
  const glm::dvec3 nearest = glm::round(point);
  const glm::dvec3 place =
      glm::mix(point, nearest, glm::lessThan(glm::abs(point - nearest), glm::dvec3(1e-6)));
  const glm::dvec3 floor = glm::floor(place), f = place - floor;
  const glm::ivec3 low(floor);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const double weight = (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
    if (weight > 0) sum += weight * at(low + step);
  }
  return sum;
}

void visitCells(const SparseGrid& grid, const std::function<void(const SparseCell& cell)>& constant,
                const std::function<void(const SparseGrid::Leaf& leaf)>& leaf) {
  if (grid.isDense()) {
    const std::size_t count = denseCount(grid.dense);
    for (std::size_t i = 0; i < count; ++i) constant({voxelAt(grid.dense, i), 1, true, i});
    return;
  }
  const auto components = static_cast<std::size_t>(grid.components);
  const auto visitTable = [&](const SparseGrid::Table& table, int log2, int cell_log2, const auto& child) {
    for (std::size_t i = 0; i < table.child.size(); ++i) {
      if (table.child[i] >= 0)
        child(static_cast<std::size_t>(table.child[i]));
      else
        constant({cellLow(table.low, i, log2, cell_log2), 1 << cell_log2, bit(table.active, i),
                  table.first + i * components});
    }
  };
  for (const SparseGrid::Root& root : grid.roots) {
    if (root.child < 0) {
      constant({root.low, SparseGrid::kUpperSide, root.active, root.first});
      continue;
    }
    visitTable(grid.upper[static_cast<std::size_t>(root.child)], SparseGrid::kUpperLog2, 7,
               [&](std::size_t lower) {
                 visitTable(grid.lower[lower], SparseGrid::kLowerLog2, 3,
                            [&](std::size_t i) { leaf(grid.leaves[i]); });
               });
  }
}

}  // namespace kelp::bake

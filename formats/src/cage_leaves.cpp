// SPDX-License-Identifier: MIT
#include "cage_leaves.h"

#include <algorithm>
#include <array>

#include <glm/common.hpp>

namespace kelp {
namespace {

// A box around cells, in sides of one.
struct CellRange {
  glm::ivec3 low{kMostCageCells}, high{0};
  std::uint32_t count = 0;

  void add(const CellRange& more) {
    low = glm::min(low, more.low);
    high = glm::max(high, more.high);
    count += more.count;
  }
  // By how likely it is that a line meets the box, and how many cells it meets then.
  std::uint64_t cost() const {
    const glm::ivec3 extent = high - low;
    const int area = extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
    return std::uint64_t{count} * static_cast<std::uint32_t>(area);
  }
};

// Fills the slots of a subtree. The halves have as many: of the ways to cut the cells by a plane between
// lattice points, the one of least cost for which they are enough.
class LeafFiller {
 public:
  explicit LeafFiller(const Cage& cage) : cage_(cage) {}

  void fill(std::span<std::uint32_t> cells, std::span<std::uint32_t> slots) {
    if (cells.empty() || slots.size() == kLeafCells) {
      std::fill(std::copy(cells.begin(), cells.end(), slots.begin()), slots.end(), kCageOutside);
      return;
    }
    const std::size_t half = slots.size() / 2, left = divide(cells, half);
    fill(cells.first(left), slots.first(half));
    fill(cells.subspan(left), slots.subspan(half));
  }

 private:
  struct Cut {
    std::uint64_t cost = ~std::uint64_t{0};
    int axis = 0, at = 0;
  };

  // Puts the cells of the lower half first, and returns their number.
  std::size_t divide(std::span<std::uint32_t> cells, std::size_t most) {
    if (cells.size() <= kLeafCells) return cells.size();
    CellRange all;
    for (const std::uint32_t cell : cells) all.add(rangeOf(cell));
    Cut best;
    for (int axis = 0; axis < 3; ++axis) tryAxis(cells, all, axis, most, best);
    if (best.at > 0) {
      const auto middle = std::partition(cells.begin(), cells.end(), [&](std::uint32_t cell) {
        return cage_.place(cell)[best.axis] < best.at;
      });
      return static_cast<std::size_t>(middle - cells.begin());
    }
    const glm::ivec3 extent = all.high - all.low;
    const int axis = extent.x >= std::max(extent.y, extent.z) ? 0 : extent.y >= extent.z ? 1 : 2;
    const auto middle = cells.begin() + static_cast<std::ptrdiff_t>(cells.size() / 2);
    std::nth_element(cells.begin(), middle, cells.end(), [&](std::uint32_t a, std::uint32_t b) {
      const int at_a = cage_.place(a)[axis], at_b = cage_.place(b)[axis];
      return at_a != at_b ? at_a < at_b : a < b;
    });
    return cells.size() / 2;
  }
  void tryAxis(std::span<const std::uint32_t> cells, const CellRange& all, int axis, std::size_t most,
               Cut& best) {
    const int first = all.low[axis], end = all.high[axis];
    std::fill(layers_.begin() + first, layers_.begin() + end, CellRange{});
    for (const std::uint32_t cell : cells) layers_[layerOf(cell, axis)].add(rangeOf(cell));
    // Costs of all from a layer on.
    CellRange above;
    for (int at = end - 1; at > first; --at) {
      above.add(layers_[static_cast<std::size_t>(at)]);
      costs_[static_cast<std::size_t>(at)] = above.cost();
    }
    CellRange below;
    for (int at = first + 1; at < end; ++at) {
      below.add(layers_[static_cast<std::size_t>(at) - 1]);
      if (below.count > most || cells.size() - below.count > most) continue;
      const std::uint64_t cost = below.cost() + costs_[static_cast<std::size_t>(at)];
      if (cost < best.cost) best = {cost, axis, at};
    }
  }
  std::size_t layerOf(std::uint32_t cell, int axis) const {
    return static_cast<std::size_t>(cage_.place(cell)[axis]);
  }
  CellRange rangeOf(std::uint32_t cell) const {
    const glm::ivec3 place = cage_.place(cell);
    return {place, place + 1, 1};
  }

  const Cage& cage_;
  std::array<CellRange, kMostCageCells> layers_;
  std::array<std::uint64_t, kMostCageCells> costs_{};
};

}  // namespace

void fillLeaves(const Cage& cage, std::span<std::uint32_t> cells, std::span<std::uint32_t> slots) {
  for (std::uint32_t i = 0; i < cage.cells(); ++i) cells[i] = i;
  LeafFiller(cage).fill(cells.first(cage.cells()), slots);
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
#include "verify/emptiness.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/formats/brick.h"

namespace kelp::dump {
namespace {

// Whether `wanted` holds for any value of a dense array between low and high, both included. Places outside
// the array count as nothing.
template <class T, class Wanted>
bool anyWithin(glm::ivec3 low, glm::ivec3 high, std::span<const T> values, const glm::ivec3& size,
               Wanted wanted) {
  low = glm::max(low, glm::ivec3(0));
  high = glm::min(high, size - 1);
  if (low.x > high.x) return false;
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      const std::span<const T> run =
          values.subspan(denseIndex(size, low.x, y, z), static_cast<std::size_t>(high.x - low.x) + 1);
      if (std::any_of(run.begin(), run.end(), wanted)) return true;
    }
  }
  return false;
}

}  // namespace

bool breaksPromise(std::uint8_t code, const glm::ivec3& voxel, const fields::Occupancy& occupancy) {
  const glm::ivec3 reach = codeReach(code);
  return anyWithin<std::uint8_t>(voxel - reach, voxel + reach, occupancy.solid, occupancy.size,
                                 [](std::uint8_t solid) { return solid != 0; });
}

bool breaksPromise(std::uint32_t cell, const glm::ivec3& brick, std::span<const std::uint32_t> cells,
                   const glm::ivec3& grid, int right_clearance) {
  if (cellClearance(cell) > right_clearance) return true;
  const glm::ivec3 down(cellReach(cell, 0), cellReach(cell, 2), cellReach(cell, 4)),
      up(cellReach(cell, 1), cellReach(cell, 3), cellReach(cell, 5));
  return anyWithin(brick - down, brick + up, cells, grid,
                   [](std::uint32_t other) { return (other & kCellSolid) != 0; });
}

std::string codeText(std::uint8_t code) {
  const glm::ivec3 reach = codeReach(code);
  return fmt::format("{} x {} x {}", reach.x, reach.y, reach.z);
}

std::string cellText(std::uint32_t cell) {
  return fmt::format("{}+{} x {}+{} x {}+{} bricks and clearance {}", cellReach(cell, 0), cellReach(cell, 1),
                     cellReach(cell, 2), cellReach(cell, 3), cellReach(cell, 4), cellReach(cell, 5),
                     cellClearance(cell));
}

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#include <algorithm>

#include "kelp/formats/level.h"
#include "morton_walk.h"
#include "voxels.h"

namespace kelp {
namespace {

// Bytes of cells in the file. Of voxels and fog, less than kStored: a clearance.
constexpr std::uint8_t kStored = 128, kInside = 129;
constexpr std::uint8_t kDistancesOutside = 0, kDistancesInside = 1, kDistancesStored = 2;

std::byte storedByte(const Lattice& lattice) {
  return static_cast<std::byte>(lattice.distances() ? kDistancesStored : kStored);
}

// Predicts the clearance of cell `at` from the cells before it: clearance grows by as much along an axis
// here as it does in the plane before. Solid bricks and cells outside of the grid count as 0.
class Prediction {
 public:
  Prediction(std::span<const std::uint32_t> cells, const glm::ivec3& grid) : cells_(cells), grid_(grid) {}

  int operator()(const glm::ivec3& at) const {
    const int x = near(at, {1, 0, 0}), y = near(at, {0, 1, 0}), z = near(at, {0, 0, 1});
    const int a = x + y - near(at, {1, 1, 0}), b = x + z - near(at, {1, 0, 1}),
              c = y + z - near(at, {0, 1, 1});
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  }

 private:
  int near(const glm::ivec3& at, const glm::ivec3& before) const {
    const glm::ivec3 v = at - before;
    if (v.x < 0 || v.y < 0 || v.z < 0) return 0;
    const std::uint32_t cell =
        cells_[static_cast<std::size_t>(v.x) +
               static_cast<std::size_t>(grid_.x) *
                   (static_cast<std::size_t>(v.y) +
                    static_cast<std::size_t>(grid_.y) * static_cast<std::size_t>(v.z))];
    return cell & kCellSolid ? 0 : cellClearance(cell);
  }

  std::span<const std::uint32_t> cells_;
  glm::ivec3 grid_;
};

// Calls visit(index, place) for every cell, x fastest, then y, then z.
template <class Visit>
void forEachCell(const glm::ivec3& grid, const Visit& visit) {
  std::size_t index = 0;
  glm::ivec3 at;
  for (at.z = 0; at.z < grid.z; ++at.z)
    for (at.y = 0; at.y < grid.y; ++at.y)
      for (at.x = 0; at.x < grid.x; ++at.x) visit(index++, at);
}

}  // namespace

void storeCells(std::span<const std::uint32_t> cells, const Lattice& lattice, std::span<std::byte> bytes) {
  if (lattice.distances()) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      bytes[i] = static_cast<std::byte>(cells[i] & kCellSolid     ? kDistancesStored
                                        : cells[i] == kFarOutside ? kDistancesOutside
                                                                  : kDistancesInside);
    return;
  }
  const glm::ivec3 grid = brickGrid(lattice.size);
  const Prediction predicted(cells, grid);
  forEachCell(grid, [&](std::size_t i, const glm::ivec3& at) {
    bytes[i] =
        static_cast<std::byte>(cells[i] == kCellInside ? kInside
                               : cells[i] & kCellSolid ? kStored
                                                       : (cellClearance(cells[i]) - predicted(at)) & 127);
  });
}

Result<std::uint32_t> countStored(std::span<const std::byte> bytes, const Lattice& lattice) {
  const std::byte most{lattice.distances() ? kDistancesStored : kInside};
  const auto wrong = std::find_if(bytes.begin(), bytes.end(), [most](std::byte b) { return b > most; });
  if (wrong != bytes.end())
    return Error{ErrorCode::kCorrupt, "a cell's byte is above 129, or above 2 of distances",
                 static_cast<std::uint64_t>(wrong - bytes.begin())};
  const auto count = std::count(bytes.begin(), bytes.end(), storedByte(lattice));
  if (count == 0) return Error{ErrorCode::kCorrupt, "a level has no brick", 0};
  if (count > std::int64_t{kCellSlotMask} + 1)
    return Error{ErrorCode::kCorrupt, "a level has more than 2^24 bricks", 0};
  return static_cast<std::uint32_t>(count);
}

Result<void> loadCells(std::span<const std::byte> bytes, const Lattice& lattice, LevelGrid& out) {
  if (lattice.distances()) {
    std::transform(bytes.begin(), bytes.end(), out.cells.begin(), [](std::byte b) {
      return std::uint32_t{b == std::byte{kDistancesOutside} ? kFarOutside : kFarInside};
    });
  } else {
    const glm::ivec3 whole = lattice.channels == 0 ? out.size / kBrickSide : glm::ivec3(0);
    const auto inside = makeStoredCell(static_cast<std::uint32_t>(out.pages.size()), 0);
    const Prediction predicted(out.cells.span(), out.grid);
    std::uint64_t wrong = bytes.size();
    forEachCell(out.grid, [&](std::size_t i, const glm::ivec3& at) {
      const auto byte = static_cast<std::uint8_t>(bytes[i]);
      if (byte == kInside && !(at.x < whole.x && at.y < whole.y && at.z < whole.z) && wrong == bytes.size())
        wrong = i;
      out.cells[i] = byte >= kStored
                         ? inside
                         : static_cast<std::uint32_t>((predicted(at) + byte) & 127) << kCellClearanceShift;
    });
    if (wrong != bytes.size())
      return Error{ErrorCode::kCorrupt, "a brick that is wholly inside reaches beyond the level, or is fog",
                   wrong};
  }
  std::uint32_t slot = 0, page = 0;
  for (MortonWalk walk(out.grid); !walk.done(); walk.next()) {
    const auto at = static_cast<std::size_t>(walk.index());
    if (bytes[at] != storedByte(lattice)) continue;
    page += slot == out.pages[page].first_slot + out.pages[page].count;
    out.cells[at] = makeStoredCell(page, slot - out.pages[page].first_slot);
    out.bricks[slot++] = static_cast<std::uint32_t>(at);
  }
  return {};
}

}  // namespace kelp

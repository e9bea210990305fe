// SPDX-License-Identifier: MIT
#include "voxels.h"

#include <algorithm>

#include "morton_walk.h"

namespace kelp {
namespace {

constexpr std::uint8_t kByteStored = 128, kByteInside = 129;

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

void storeCells(std::span<const std::uint32_t> cells, const glm::ivec3& grid, std::span<std::byte> bytes) {
  const Prediction predicted(cells, grid);
  forEachCell(grid, [&](std::size_t i, const glm::ivec3& at) {
    bytes[i] =
        static_cast<std::byte>(cells[i] == kCellInside ? kByteInside
                               : cells[i] & kCellSolid ? kByteStored
                                                       : (cellClearance(cells[i]) - predicted(at)) & 127);
  });
}

Result<std::uint32_t> countStored(std::span<const std::byte> bytes) {
  const auto wrong =
      std::find_if(bytes.begin(), bytes.end(), [](std::byte b) { return b > std::byte{kByteInside}; });
  if (wrong != bytes.end())
    return Error{ErrorCode::kCorrupt, "a cell's byte is above 129",
                 static_cast<std::uint64_t>(wrong - bytes.begin())};
  const auto count = std::count(bytes.begin(), bytes.end(), std::byte{kByteStored});
  if (count == 0) return Error{ErrorCode::kCorrupt, "a level has no brick", 0};
  if (count > std::int64_t{kCellSlotMask} + 1)
    return Error{ErrorCode::kCorrupt, "a level has more than 2^24 bricks", 0};
  return static_cast<std::uint32_t>(count);
}

Result<void> loadCells(std::span<const std::byte> bytes, int channels, LevelGrid& out) {
  const glm::ivec3 whole = channels == 0 ? out.size / kBrickSide : glm::ivec3(0);
  const auto inside = makeStoredCell(static_cast<std::uint32_t>(out.pages.size()), 0);
  const Prediction predicted(out.cells.span(), out.grid);
  std::uint64_t wrong = bytes.size();
  forEachCell(out.grid, [&](std::size_t i, const glm::ivec3& at) {
    const auto byte = static_cast<std::uint8_t>(bytes[i]);
    if (byte == kByteInside && !(at.x < whole.x && at.y < whole.y && at.z < whole.z) && wrong == bytes.size())
      wrong = i;
    out.cells[i] = byte >= kByteStored
                       ? inside
                       : static_cast<std::uint32_t>((predicted(at) + byte) & 127) << kCellClearanceShift;
  });
  if (wrong != bytes.size())
    return Error{ErrorCode::kCorrupt, "a brick that is wholly inside reaches beyond the level, or is fog",
                 wrong};
  std::uint32_t slot = 0, page = 0;
  for (MortonWalk walk(out.grid); !walk.done(); walk.next()) {
    const auto at = static_cast<std::size_t>(walk.index());
    if (bytes[at] != std::byte{kByteStored}) continue;
    page += slot == out.pages[page].first_slot + out.pages[page].count;
    out.cells[at] = makeStoredCell(page, slot - out.pages[page].first_slot);
    out.bricks[slot++] = static_cast<std::uint32_t>(at);
  }
  return {};
}

}  // namespace kelp

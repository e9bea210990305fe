// SPDX-License-Identifier: MIT
#include "page_frame.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "eight_codes.h"
#include "kelp/formats/empty_boxes.h"
#include "kelp/formats/level.h"

namespace kelp {
namespace {

constexpr BrickBits kFullBits = [] {
  BrickBits bits;
  for (std::uint64_t& slice : bits.slices) slice = ~std::uint64_t{0};
  return bits;
}();

bool isWithin(const glm::ivec3& brick, const glm::ivec3& grid) {
  return brick.x >= 0 && brick.y >= 0 && brick.z >= 0 && brick.x < grid.x && brick.y < grid.y &&
         brick.z < grid.z;
}
std::size_t cellAt(const glm::ivec3& brick, const glm::ivec3& grid) {
  return static_cast<std::size_t>(brick.x) +
         static_cast<std::size_t>(grid.x) *
             (static_cast<std::size_t>(brick.y) +
              static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(brick.z));
}

// Calls visit(cell) for the stored bricks of the next coarser level over a brick and over all that its boxes
// reach: up to eight.
template <class Visit>
void forEachOver(const glm::ivec3& brick, const LevelGrid& over, const Visit& visit) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 coarse = (brick + 2 * glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2) - 1) >> 1;
    if (!isWithin(coarse, over.grid)) continue;
    const std::uint32_t cell = over.cells[cellAt(coarse, over.grid)];
    if ((cell & kCellSolid) && !over.isInside(cell)) visit(cell);
  }
}

// The shape of a stored brick of the coarser level, if it is known.
const BrickShape* shapeOf(const LevelAbove& over, std::uint32_t cell) {
  const BrickShape& shape = over.shapes[over.grid->slotOf(cell)];
  std::uint64_t any = 0;
  for (const std::uint64_t slice : shape.surface.slices) any |= slice;
  return any ? &shape : nullptr;
}

// Bit i of four -> bits 2 i and 2 i + 1.
constexpr std::array<std::uint8_t, 16> kTwice = [] {
  std::array<std::uint8_t, 16> twice{};
  for (std::size_t four = 0; four < twice.size(); ++four)
    for (std::size_t i = 0; i < 4; ++i)
      if (four >> i & 1) twice[four] = static_cast<std::uint8_t>(twice[four] | 3u << (2 * i));
  return twice;
}();

// The finer voxels below solid coarser ones. brick: the finer brick's place.
void spreadSolid(const BrickBits& coarse, const glm::ivec3& brick, BrickBits& fine) {
  const int x = 4 * (brick.x & 1), y = 4 * (brick.y & 1), z = 4 * (brick.z & 1);
  for (int k = 0; k < 4; ++k) {
    std::uint64_t slice = 0;
    for (int j = 0; j < 4; ++j) {
      const std::uint64_t row = kTwice[coarse.slices[z + k] >> (8 * (y + j) + x) & 15];
      slice |= (row | row << 8) << (16 * j);
    }
    fine.slices[2 * k] = fine.slices[2 * k + 1] = slice;
  }
}

// The solid voxels of a brick and of the 26 beside it, as far as a page knows.
class Surroundings {
 public:
  Surroundings(const LevelGrid& grid, std::size_t page, const LevelAbove& over,
               std::span<const BrickShape> shapes)
      : grid_(grid), page_(page), over_(over), shapes_(shapes) {}

  void gather(const glm::ivec3& brick, BoxWindow& window) const {
    BrickBits spread;
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 at(i % 3, i / 3 % 3, i / 9);
      const BrickBits& bits = solidOf(brick + at - 1, spread);
      std::uint64_t* const slices = window.slices[at.x][at.y].data() + kBoxReach + kBrickSide * (at.z - 1);
      const int first = at.z == 0 ? kBrickSide - kBoxReach : 0, end = at.z == 2 ? kBoxReach : kBrickSide;
      for (int z = first; z < end; ++z) slices[z] = bits.slices[z];
    }
  }

 private:
  const BrickBits& solidOf(const glm::ivec3& brick, BrickBits& spread) const {
    if (!isWithin(brick, grid_.grid)) return kEmptyBits;
    const std::uint32_t cell = grid_.cells[cellAt(brick, grid_.grid)];
    if (!(cell & kCellSolid)) return kEmptyBits;
    if (cellPage(cell) == page_) return shapes_[cellBrick(cell)].solid;
    if (grid_.isInside(cell) || !over_.grid) return kFullBits;
    const std::uint32_t above = over_.grid->cells[cellAt(brick >> 1, over_.grid->grid)];
    const BrickShape* const coarse =
        (above & kCellSolid) && !over_.grid->isInside(above) ? shapeOf(over_, above) : nullptr;
    if (!coarse) return kFullBits;
    spreadSolid(coarse->solid, brick, spread);
    return spread;
  }

  const LevelGrid& grid_;
  std::size_t page_;
  const LevelAbove& over_;
  std::span<const BrickShape> shapes_;
};

}  // namespace

Result<void> PagesAbove::make(const LevelGrid& grid, const LevelGrid& over) {
  // Counts, then fills. A page is listed once: `last` has the page of the level that listed it last.
  Buffer<std::uint32_t> last(pages.allocator());
  if (!last.reset(over.pages.size()) || !first.reset(grid.pages.size() + 1))
    return Error{ErrorCode::kOutOfMemory, "no memory for a level"};
  for (const bool fill : {false, true}) {
    std::fill(last.begin(), last.end(), ~0u);
    std::uint32_t count = 0;
    for (std::uint32_t page = 0; page < grid.pages.size(); ++page) {
      const std::uint32_t begin = count;
      first[page] = begin;
      for (std::uint32_t i = 0; i < grid.pages[page].count; ++i) {
        forEachOver(grid.place(grid.pages[page].first_slot + i), over, [&](std::uint32_t cell) {
          if (std::exchange(last[cellPage(cell)], page) == page) return;
          if (fill) pages[count] = cellPage(cell);
          ++count;
        });
      }
      if (fill) std::sort(pages.begin() + begin, pages.begin() + count);
    }
    first[grid.pages.size()] = count;
    if (!fill && !pages.reset(count)) return Error{ErrorCode::kOutOfMemory, "no memory for a level"};
  }
  return {};
}

bool PagesAbove::isOver(const LevelGrid& grid, std::size_t page, const LevelGrid& above,
                        std::uint32_t coarser) {
  for (std::uint32_t i = 0; i < grid.pages[page].count; ++i) {
    const std::uint32_t cell =
        above.cells[cellAt(grid.place(grid.pages[page].first_slot + i) >> 1, above.grid)];
    if ((cell & kCellSolid) && cellPage(cell) == coarser) return true;
  }
  return false;
}

CoarseBlock blockOver(const BrickShape& coarse, const glm::ivec3& brick) {
  const int x = 4 * (brick.x & 1), y = 4 * (brick.y & 1), z = 4 * (brick.z & 1);
  const auto block = [&](const BrickBits& bits) {
    std::uint64_t out = 0;
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j) out |= (bits.slices[z + k] >> (8 * (y + j) + x) & 15) << (4 * j + 16 * k);
    return out;
  };
  return {block(coarse.solid), block(coarse.surface)};
}

Result<void> PageFrame::make(const LevelGrid& grid, std::size_t page, const LevelAbove& over,
                             std::size_t palette) {
  const PageInfo& info = grid.pages[page];
  for (std::uint32_t i = 0; i < info.count; ++i) {
    const glm::ivec3 brick = bricks[i] = grid.place(info.first_slot + i);
    if (grid.coarsest) continue;
    const std::uint32_t cell = over.grid->cells[cellAt(brick >> 1, over.grid->grid)];
    if (!(cell & kCellSolid) || over.grid->isInside(cell))
      return Error{ErrorCode::kCorrupt, "a stored brick lies below one that is not stored", info.offset};
    const BrickShape* const coarse = shapeOf(over, cell);
    if (!coarse) return Error{ErrorCode::kMisuse, "coarser bricks over the page are not known", info.offset};
    above[i] = blockOver(*coarse, brick);
  }
  shape.bricks = std::span(bricks).first(info.count);
  shape.above = grid.coarsest ? std::span<const CoarseBlock>() : std::span(above).first(info.count);
  shape.size = grid.size;
  shape.palette = static_cast<std::uint32_t>(palette);
  return {};
}

void writeBricks(const LevelGrid& grid, std::size_t page, const LevelAbove& over,
                 std::span<const BrickShape> shapes, std::span<std::uint32_t> words) {
  const Surroundings surroundings(grid, page, over, shapes);
  BoxWindow window;
  // Offsets of attributes fit 16 bits, because a page has at most 64 KiB of codes and attributes.
  std::uint32_t attribute = kBrickWords * static_cast<std::uint32_t>(shapes.size());
  for (std::uint32_t i = 0; i < shapes.size(); ++i, attribute -= kBrickWords) {
    std::uint32_t* const brick = &words[std::size_t{i} * kBrickWords];
    auto* const codes = reinterpret_cast<std::uint8_t*>(brick + kSliceWords);
    for (std::size_t z = 0; z < kBrickSide; ++z) {
      std::uint32_t& pair = brick[z / 2];
      pair = z % 2 == 0 ? attribute : pair | attribute << 16;
      const std::uint64_t solid = shapes[i].solid.slices[z], surface = shapes[i].surface.slices[z];
      std::uint64_t rank = 0;
      for (std::size_t y = 0; y < kBrickSide; ++y) {
        EightCodes eight(static_cast<std::uint8_t>(surface >> (8 * y)),
                         static_cast<std::uint8_t>(solid >> (8 * y)));
        const std::uint64_t which = eight.surfaceBytes(), voxels = eight.surfaceVoxels();
        eight.codes = (eight.codes & ~which) | (eight.ranked(rank) & which);
        eight.store(codes + 64 * z + 8 * y);
        rank += voxels;
      }
      attribute += static_cast<std::uint32_t>(rank);
    }
    surroundings.gather(grid.place(grid.pages[page].first_slot + i), window);
    chooseBoxes(window, std::span<std::uint8_t, kBrickVoxels>(codes, kBrickVoxels));
  }
}

void shapesOf(std::span<const std::uint8_t> codes, std::span<BrickShape> shapes) {
  for (std::size_t i = 0; i < shapes.size() * 64; ++i) {
    const EightCodes eight(codes.data() + 8 * i);
    constexpr std::uint64_t kGather = 0x0102040810204080u;
    const std::uint64_t surface = eight.surface() * kGather >> 56,
                        inner = (eight.codes >> 7 & EightCodes::kOnes) * kGather >> 56;
    BrickShape& shape = shapes[i / 64];
    const std::size_t slice = i / 8 % 8, shift = 8 * (i % 8);
    if (shift == 0) shape.solid.slices[slice] = shape.surface.slices[slice] = 0;
    shape.surface.slices[slice] |= surface << shift;
    shape.solid.slices[slice] |= (surface | inner) << shift;
  }
}

}  // namespace kelp

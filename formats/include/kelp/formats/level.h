// SPDX-License-Identifier: MIT
// Levels of a pack, for programs that read voxels themselves: grids, the pages that each page is decoded
// with, and a reader of whole levels. A game needs none of this.
#pragma once

#include <cstdint>
#include <span>

#include "kelp/formats/brick.h"
#include "kelp/formats/buffer.h"
#include "kelp/formats/distance.h"
#include "kelp/formats/pack.h"
#include "kelp/formats/page.h"

namespace kelp {

// The grid of one level of one part, of voxels, fog or distances, and the pages that hold its bricks.
struct LevelGrid {
  LevelGrid() = default;
  explicit LevelGrid(const Allocator& allocator) : cells(allocator), bricks(allocator), pages(allocator) {}

  int part = 0;
  int level = 0;
  bool coarsest = false;  // of the part
  glm::ivec3 size{0};     // of this level: voxels, or cubes of fog
  glm::ivec3 grid{0};     // bricks
  DistanceBand band;      // of distances
  // One a brick, x fastest, then y, then z: kelp/formats/page.h.
  Buffer<std::uint32_t> cells;
  Buffer<std::uint32_t> bricks;  // one a stored brick, by slot: the index of its cell
  Buffer<PageInfo> pages;        // ascending slots, no gaps

  // Where the brick of a slot is in the grid.
  glm::ivec3 place(std::uint32_t slot) const {
    const auto cell = static_cast<int>(bricks[slot]);
    return {cell % grid.x, cell / grid.x % grid.y, cell / grid.x / grid.y};
  }
  bool isInside(std::uint32_t cell) const { return (cell & kCellSolid) && cellPage(cell) == pages.size(); }
  // The slot of a stored cell.
  std::uint32_t slotOf(std::uint32_t cell) const {
    return pages[cellPage(cell)].first_slot + cellBrick(cell);
  }
};

// The shapes of the next coarser level, which decoding the pages of a level of voxels needs.
struct LevelAbove {
  const LevelGrid* grid = nullptr;     // null: there is none
  std::span<const BrickShape> shapes;  // one a stored brick, by slot; without surface: not known yet
};

// The pages of the next coarser level that a level's pages are decoded with: those over their bricks, which
// decoding needs, and those beside, which empty boxes reach.
struct PagesAbove {
  PagesAbove() = default;
  explicit PagesAbove(const Allocator& allocator) : first(allocator), pages(allocator) {}

  Buffer<std::uint32_t> first;  // one a page of the level, and one more: where its pages begin in `pages`
  Buffer<std::uint32_t> pages;  // ascending for each page

  // kOutOfMemory.
  Result<void> make(const LevelGrid& grid, const LevelGrid& above);
  // True if page `coarser` of the coarser level covers a brick of `page`.
  static bool isOver(const LevelGrid& grid, std::size_t page, const LevelGrid& above, std::uint32_t coarser);
  std::span<const std::uint32_t> of(std::size_t page) const {
    return pages.span().subspan(first[page], first[page + 1] - first[page]);
  }
};

// Reads one level of one part, page by page, for programs that want all of it.
class LevelReader {
 public:
  // Reads the level's grid and, of voxels, all coarser levels: about a third as many bytes. Errors of
  // Pack::readGrid and Pack::readPage. The pack must outlive the reader.
  static Result<LevelReader> open(const Pack& pack, int part, int level, const Allocator& allocator = {});

  const LevelGrid& grid() const { return grid_; }
  LevelGrid& grid() { return grid_; }
  // Like Pack::readPage.
  Result<void> readPage(std::size_t page, PageData& out) const;
  // Goes on to the next finer level; of voxels it reads all pages of this one again.
  Result<void> refine();

 private:
  explicit LevelReader(const Pack& pack, const Allocator& allocator)
      : pack_(&pack), allocator_(allocator), grid_(allocator), above_(allocator), shapes_(allocator) {}

  const Pack* pack_;
  Allocator allocator_;
  LevelGrid grid_, above_;
  Buffer<BrickShape> shapes_;  // of above_
};

}  // namespace kelp

// SPDX-License-Identifier: MIT
#include "level_store.h"

#include <algorithm>
#include <new>

#include "kelp/formats/fog.h"

namespace kelp::runtime {

Result<void> LevelState::load(const Pack& pack, const LevelState* coarser, const Allocator& allocator) {
  constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for the pages of a level"};
  Result<LevelGrid> read = pack.readGrid(part, level);
  if (!read) return read.error();
  const std::size_t count = read->pages.size();
  if (pack.parts()[static_cast<std::size_t>(part)].kind == PartKind::kSolid) {
    shapes = Buffer<BrickShape>(allocator);
    needs = PagesAbove(allocator);
    if ((level > 0 && !shapes.reset(read->bricks.size())) || (coarser && !needs.make(*read, coarser->grid)))
      return kNoMemory;
  }
  void* const memory = allocator.allocate(allocator.user, (count + 1) * sizeof(PageSlot));
  if (!memory) return kNoMemory;
  grid = *std::move(read);
  pages = static_cast<PageSlot*>(memory);
  for (std::size_t page = 0; page <= count; ++page) new (&pages[page]) PageSlot;
  pages[count].words.store(const_cast<std::uint32_t*>(kSolidBrick.data()),  // NOLINT: only read
                           std::memory_order_relaxed);
  absent = static_cast<std::uint32_t>(count);
  data = {grid.size, grid.grid, grid.cells.span(), grid.pages.span()};
  return {};
}

void LevelState::release(const Allocator& allocator) {
  if (!pages) return;
  for (std::size_t page = 0; page < grid.pages.size(); ++page) {
    if (std::uint32_t* words = pages[page].words.load(std::memory_order_relaxed)) {
      allocator.deallocate(allocator.user, words, pageWords(grid.pages[page]) * sizeof(std::uint32_t));
    }
    pages[page].~PageSlot();
  }
  pages[grid.pages.size()].~PageSlot();
  allocator.deallocate(allocator.user, pages, (grid.pages.size() + 1) * sizeof(PageSlot));
  pages = nullptr;
}

std::uint64_t LevelState::estimatedBytes(const Part& of) const {
  const glm::ivec3 bricks = brickGrid(latticeSize(of.kind, levelSize(of.size, level)));
  const std::uint64_t cells = static_cast<std::uint64_t>(bricks.x) * static_cast<std::uint64_t>(bricks.y) *
                              static_cast<std::uint64_t>(bricks.z);
  const std::uint64_t page_count = (grid_raw - std::min(grid_raw, cells)) / 32;  // a page has 32 bytes
  const std::uint64_t stored = std::min(cells, page_count * kMaxPageBricks);
  const bool has_shapes = of.kind == PartKind::kSolid && level > 0;
  return (cells + stored) * sizeof(std::uint32_t) + stored * (has_shapes ? sizeof(BrickShape) : 0) +
         page_count * (sizeof(PageInfo) + sizeof(PageSlot)) + sizeof(PageSlot);
}

std::uint64_t LevelState::bytes() const {
  return (grid.cells.size() + grid.bricks.size() + needs.first.size() + needs.pages.size()) *
             sizeof(std::uint32_t) +
         shapes.size() * sizeof(BrickShape) + grid.pages.size() * (sizeof(PageInfo) + sizeof(PageSlot)) +
         sizeof(PageSlot);
}

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
#include "level_store.h"

#include <algorithm>
#include <new>

#include "kelp/formats/fog.h"

namespace kelp::runtime {

Result<void> LevelState::load(const Pack& pack, const Allocator& allocator) {
  Result<LevelGrid> read = pack.readGrid(part, level);
  if (!read) return read.error();
  const std::size_t count = read->pages.size();
  if (count >= kMaxPages) return Error{ErrorCode::kLimit, "a level has more than 131071 pages"};
  // Where each slot lies. Pages are in the order of slots.
  Buffer<std::uint32_t> places(allocator);
  const auto bytes_of_slots = (count + 1) * sizeof(PageSlot);
  void* const memory = allocator.allocate(allocator.user, bytes_of_slots);
  if (!memory || !places.reset(read->bricks)) {
    if (memory) allocator.deallocate(allocator.user, memory, bytes_of_slots);
    return Error{ErrorCode::kOutOfMemory, "no memory for the pages of a level"};
  }
  for (std::size_t page = 0; page < count; ++page) {
    const PageInfo& info = read->pages[page];
    for (std::uint32_t brick = 0; brick < info.count; ++brick)
      places[info.first_slot + brick] = makeStoredCell(static_cast<std::uint32_t>(page), brick);
  }
  for (std::uint32_t& cell : read->cells) {
    if (cell == kCellInside)
      cell = makeStoredCell(static_cast<std::uint32_t>(count), 0);
    else if (cell & kCellSolid)
      cell = places[cell & kCellSlotMask];
  }
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

std::uint64_t LevelState::bytes(const Part& of) const {
  const glm::ivec3 bricks = brickGrid(latticeSize(of.kind, levelSize(of.size, level)));
  const std::uint64_t cells = static_cast<std::uint64_t>(bricks.x) * static_cast<std::uint64_t>(bricks.y) *
                              static_cast<std::uint64_t>(bricks.z);
  const std::uint64_t table = grid_raw - std::min(grid_raw, cells * sizeof(std::uint32_t));
  const std::uint64_t page_count = table / 32;  // a page has 32 bytes in the file
  return cells * sizeof(std::uint32_t) + page_count * (sizeof(PageInfo) + sizeof(PageSlot)) +
         sizeof(PageSlot);
}

}  // namespace kelp::runtime

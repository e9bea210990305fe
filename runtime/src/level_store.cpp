// SPDX-License-Identifier: MIT
#include "level_store.h"

#include <algorithm>
#include <new>

#include "kelp/formats/fog.h"

namespace kelp::runtime {
namespace {

// The slots of so many pages, and their groups.
std::uint64_t slotBytes(std::uint64_t pages) { return pages * sizeof(PageSlot) + (pages + kGroup - 1) / kGroup * sizeof(PageGroup); }

}  // namespace

Result<void> LevelState::load(const Pack& pack, const Allocator& allocator) {
  Result<LevelGrid> read = pack.readGrid(part, level);
  if (!read) return read.error();
  const std::size_t count = read->pages.size();
  if (count > kMaxPages) return Error{ErrorCode::kLimit, "a level has more than 131072 pages"};
  // Where each slot is: the pages are in the order of slots.
  Buffer<std::uint32_t> places(allocator);
  const auto bytes_of_slots = static_cast<std::size_t>(slotBytes(count));
  void* const memory = allocator.allocate(allocator.user, bytes_of_slots);
  if (!memory || !places.reset(read->bricks)) {
    if (memory) allocator.deallocate(allocator.user, memory, bytes_of_slots);
    return Error{ErrorCode::kOutOfMemory, "no memory for the pages of a level"};
  }
  for (std::size_t page = 0; page < count; ++page) {
    const PageInfo& info = read->pages[page];
    for (std::uint32_t brick = 0; brick < info.count; ++brick) places[info.first_slot + brick] = makeStoredCell(static_cast<std::uint32_t>(page), brick);
  }
  for (std::uint32_t& cell : read->cells) {
    if (cell & kCellSolid) cell = places[cell & kCellSlotMask];
  }
  grid = *std::move(read);
  pages = static_cast<PageSlot*>(memory);
  groups = reinterpret_cast<PageGroup*>(pages + count);
  for (std::size_t page = 0; page < count; ++page) new (&pages[page]) PageSlot;
  for (std::uint32_t group = 0; group < groupCount(); ++group) {
    new (&groups[group]) PageGroup;
    groups[group].absent = std::min(kGroup, static_cast<std::uint32_t>(count) - group * kGroup);
  }
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
  for (std::uint32_t group = 0; group < groupCount(); ++group) groups[group].~PageGroup();
  allocator.deallocate(allocator.user, pages, static_cast<std::size_t>(slotBytes(grid.pages.size())));
  pages = nullptr;
}

std::uint64_t LevelState::bytes(const Part& of) const {
  const glm::ivec3 bricks = brickGrid(latticeSize(of.kind, levelSize(of.size, level)));
  const std::uint64_t cells = static_cast<std::uint64_t>(bricks.x) * static_cast<std::uint64_t>(bricks.y) * static_cast<std::uint64_t>(bricks.z);
  const std::uint64_t table = grid_raw - std::min(grid_raw, cells * sizeof(std::uint32_t));
  const std::uint64_t page_count = table / 32;  // 32 bytes each in the file
  return cells * sizeof(std::uint32_t) + page_count * sizeof(PageInfo) + slotBytes(page_count);
}

}  // namespace kelp::runtime

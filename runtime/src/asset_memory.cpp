// SPDX-License-Identifier: MIT
// Which pages are dropped, so that an asset stays within its budget.
#include <algorithm>

#include "asset_impl.h"

namespace kelp::runtime {

void Asset::Impl::evict(LevelState& level, std::uint32_t page) {
  PageSlot& slot = level.pages[page];
  std::uint32_t* words = nullptr;
  {
    std::lock_guard alone(readers);
    if (slot.pins.load(std::memory_order_acquire) == 0)
      words = slot.words.exchange(nullptr, std::memory_order_relaxed);
    // Under the lock, so that no reader takes the level for complete.
    if (words) {
      level.resident.fetch_sub(1, std::memory_order_relaxed);
      if (page < level.first_missing.load(std::memory_order_relaxed))
        level.first_missing.store(page, std::memory_order_relaxed);
    }
  }
  if (!words) return;
  const std::uint64_t bytes = level.pageBytes(page);
  options.allocator.deallocate(options.allocator.user, words, static_cast<std::size_t>(bytes));
  used_bytes.fetch_sub(bytes, std::memory_order_relaxed);
  page_bytes -= bytes;
  setStage({&level, page}, Stage::kAbsent);
}

// True if a page in memory may be dropped: it is not pinned and was not used recently.
bool Asset::Impl::mayGo(const PageSlot& slot) const {
  return slot.stage == Stage::kResident && slot.pins.load(std::memory_order_relaxed) == 0 &&
         round.load(std::memory_order_relaxed) - slot.used.load(std::memory_order_relaxed) >= kPatience;
}

// True if a page has not been used since findIdle() found it.
bool Asset::Impl::isStillIdle(const Idle& found) const {
  const PageSlot& slot = found.level->pages[found.page];
  return slot.stage == Stage::kResident && slot.pins.load(std::memory_order_relaxed) == 0 &&
         slot.used.load(std::memory_order_relaxed) == found.used;
}

// Finds the pages that were not used for longest. They are the next to drop, because every page that is
// loaded or used later is younger.
void Asset::Impl::findIdle() {
  const std::uint32_t now = round.load(std::memory_order_relaxed);
  const auto goesBefore = [now](const Idle& a, const Idle& b) {  // the finest first among equals
    if (a.used != b.used) return now - a.used > now - b.used;
    return a.level != b.level ? a.level->index > b.level->index : a.page > b.page;
  };
  idle_next = 0;
  idle_count = 0;
  for (std::size_t i = 0; i < voxel_count; ++i) {
    LevelState& level = states[i];
    if (!level.dropsPages() || level.stage != Stage::kResident ||
        level.resident.load(std::memory_order_relaxed) == 0)
      continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page) {
      const PageSlot& slot = level.pages[page];
      if (slot.stage != Stage::kResident || slot.pins.load(std::memory_order_relaxed) != 0) continue;
      const Idle found{&level, page, slot.used.load(std::memory_order_relaxed)};
      if (idle_count == kKept) {
        if (!goesBefore(found, idle_pages[0])) continue;
        std::pop_heap(idle_pages, idle_pages + idle_count--, goesBefore);
      }
      idle_pages[idle_count++] = found;
      std::push_heap(idle_pages, idle_pages + idle_count, goesBefore);
    }
  }
  std::sort_heap(idle_pages, idle_pages + idle_count, goesBefore);
}

// Bytes of the budget that are free or can be freed. Stops counting at `enough`.
std::uint64_t Asset::Impl::roomLeft(std::uint64_t enough) const {
  const std::uint64_t unused =
      options.memory_budget - std::min(options.memory_budget, used_bytes.load(std::memory_order_relaxed));
  std::uint64_t room = unused;
  for (std::size_t i = idle_next; i < idle_count && room < enough; ++i) {
    const Idle& found = idle_pages[i];
    if (isStillIdle(found) && mayGo(found.level->pages[found.page]))
      room += bytesOf({found.level, found.page});
  }
  if (room >= enough) return room;
  room = unused;
  for (std::size_t i = 0; i < voxel_count && room < enough; ++i) {
    LevelState& level = states[i];
    if (!level.dropsPages() || level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size() && room < enough; ++page) {
      if (mayGo(level.pages[page])) room += bytesOf({&level, page});
    }
  }
  return room;
}

// Reserves `bytes` of the budget and drops the pages that were not used for longest. For a coarsest level,
// which nothing can replace, it drops any page that is not pinned. False if that is not enough.
bool Asset::Impl::makeRoom(std::uint64_t bytes, bool coarsest) {
  bool is_fresh = false;
  while (used_bytes.load(std::memory_order_relaxed) + bytes > options.memory_budget) {
    while (idle_next < idle_count && !isStillIdle(idle_pages[idle_next])) ++idle_next;
    const bool found = idle_next < idle_count &&
                       (coarsest || mayGo(idle_pages[idle_next].level->pages[idle_pages[idle_next].page]));
    if (found) {
      const Idle& oldest = idle_pages[idle_next++];
      evict(*oldest.level, oldest.page);
      is_fresh = false;
    } else {
      if (is_fresh) return false;
      findIdle();
      is_fresh = true;
    }
  }
  used_bytes.fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

void PageReader::askAhead(const LevelState& level, const LevelState& in_use) const {
  constexpr int kAhead = 16;
  const std::uint64_t used = impl_.used_bytes.load(std::memory_order_relaxed),
                      pages = impl_.page_bytes.load(std::memory_order_relaxed),
                      wanted = level.page_bytes + (in_use.dropsPages() ? in_use.page_bytes : 0);
  if (used - std::min(used, pages) + wanted > impl_.options.memory_budget) return;
  keep(level);
  const auto count = static_cast<std::uint32_t>(level.data.pages.size());
  const auto isThere = [&](std::uint32_t page) {
    return level.pages[page].words.load(std::memory_order_relaxed) != nullptr;
  };
  std::uint32_t page = level.first_missing.load(std::memory_order_relaxed);
  while (page < count && isThere(page)) ++page;
  level.first_missing.store(page, std::memory_order_relaxed);
  for (int asked = 0; page < count && asked < kAhead; ++page) {
    if (level.pages[page].failed.load(std::memory_order_relaxed)) return;
    if (isThere(page)) continue;
    impl_.ask(level, page, 1.0f, now_);
    ++asked;
  }
}

// Bytes that the task will add to used_bytes.
std::uint64_t Asset::Impl::bytesOf(const Task& task) const {
  const LevelState& level = *task.level;
  if (task.page == Task::kGrid)
    return level.estimatedBytes(pack.parts()[static_cast<std::size_t>(level.part)]);
  return level.distances ? 0 : level.pageBytes(task.page);  // of distances, the grid has reserved it
}

}  // namespace kelp::runtime

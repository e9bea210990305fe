// SPDX-License-Identifier: MIT
// What an asset holds. pump() decides under `mutex` what is loaded next, and reads and decodes without it.
#pragma once

#include <condition_variable>
#include <mutex>
#include <shared_mutex>

#include "level_store.h"

namespace kelp::runtime {

// A request, or a look at a page, counts for this many rounds.
constexpr std::uint32_t kPatience = 8;

// Memory a thread decodes pages into; kept for the next one.
struct Scratch {
  PageData page;
  Scratch* next = nullptr;
};

// Levels that follow each other in the order of loading. Counts are guarded by the asset's mutex.
struct LevelGroup {
  std::uint32_t open = 0;           // levels of which something is absent
  std::uint32_t open_coarsest = 0;  // of these the coarsest of their parts
  Ceiling ceiling;
};

struct Asset::Impl {
  Impl(Pack&& opened, const Options& given) : pack(std::move(opened)), options(given), first_level(given.allocator), place(given.allocator) {}
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  // Something to load: a page, or (kGrid) the level's grid.
  struct Task {
    static constexpr std::uint32_t kGrid = ~0u;
    LevelState* level = nullptr;
    std::uint32_t page = kGrid;
  };
  enum class Wanted : std::uint8_t { kAsked, kAll };
  static constexpr std::uint64_t kAnySize = ~std::uint64_t{0};

  // A resident page, and when it was last looked at.
  struct Idle {
    LevelState* level = nullptr;
    std::uint32_t page = 0;
    std::uint32_t used = 0;
  };

  Result<void> prepareLevels();
  LevelState* find(int part, int level) const;
  Result<bool> pump(Wanted wanted);
  void ask(LevelState& level, float urgency, std::uint32_t now);
  void ask(const LevelState& level, std::uint32_t page, float urgency, std::uint32_t now);

  // With the mutex held.
  Task choose(Wanted wanted, std::uint64_t below);
  bool isNext(const LevelState& level) const;
  Task firstAbsent(bool coarsest_only, std::uint64_t below);
  Task mostUrgent();
  Task mostUrgentBelow(std::uint64_t below);
  float mostUrgentOf(LevelState& level, Task& task);
  float urgencyOf(const Request& request) const;
  void noteOpen(LevelState& level);
  void setAbsent(LevelState& level, std::uint32_t page);
  bool mayGo(const PageSlot& slot) const;
  bool isStillIdle(const Idle& idle) const;
  void findIdle();
  std::uint64_t roomLeft(std::uint64_t enough) const;
  bool makeRoom(std::uint64_t bytes, bool coarsest);
  void evict(LevelState& level, std::uint32_t page);
  std::uint64_t bytesOf(const Task& task) const;
  void finish(const Task& task, std::uint64_t reserved, bool done);
  Error fail(const Error& error);

  // Without.
  void raise(const LevelState& level, float urgency);
  void raise(const LevelState& level, std::uint32_t page, float urgency);
  Result<void> loadPage(const Task& task, Scratch& scratch);

  Pack pack;
  Options options;
  std::unique_ptr<LevelState[]> states;  // in the order of loading: coarse to fine, then by part
  std::size_t state_count = 0;
  std::unique_ptr<Ceiling[]> ceilings;        // of each of them
  std::unique_ptr<LevelGroup[]> level_groups;
  std::size_t level_group_count = 0;
  Buffer<std::uint32_t> first_level;  // of each part, into `place`
  Buffer<std::uint32_t> place;        // part-major -> index into `states`

  std::mutex mutex;
  std::condition_variable idle;       // in_hand became 0
  std::uint64_t ended = 0;            // tasks that left hands, well or not
  std::uint32_t in_hand = 0;          // grids and pages that threads work on now
  Scratch* scratch = nullptr;
  Error first_error;
  bool any_error = false;
  std::atomic<std::uint64_t> used_bytes{0};
  std::uint64_t page_bytes = 0;       // of these, the resident pages that may be dropped, sooner or later
  static constexpr std::size_t kIdleKept = 64;
  Idle idle_pages[kIdleKept];         // [idle_next, idle_count): those that were not looked at for longest, first the oldest
  std::size_t idle_next = 0, idle_count = 0;

  std::atomic<std::uint32_t> round{0};     // of requests; 0: nobody asked yet
  std::shared_mutex readers;          // shared by those who look at pages; owned while pages are dropped
};

// Looks at pages: those that it finds stay in memory while it lives. Any number at a time, on any threads.
class PageReader {
 public:
  explicit PageReader(const Asset& asset) : impl_(*asset.impl_), lock_(asset.impl_->readers), now_(impl_.round.load(std::memory_order_relaxed)) {}

  const LevelState* level(int part, int level) const {
    const LevelState* state = impl_.find(part, level);
    return state && state->ready.load(std::memory_order_acquire) ? state : nullptr;
  }
  // The page's words; null, and it is asked for, if it is not resident.
  const std::uint32_t* words(const LevelState& level, std::uint32_t page) const {
    PageSlot& slot = level.pages[page];
    const std::uint32_t* found = slot.words.load(std::memory_order_acquire);
    if (found) {
      slot.used.store(now_, std::memory_order_relaxed);
    } else {
      impl_.ask(level, page, 1.0f, now_);
    }
    return found;
  }

 private:
  Asset::Impl& impl_;
  std::shared_lock<std::shared_mutex> lock_;
  std::uint32_t now_;
};

}  // namespace kelp::runtime

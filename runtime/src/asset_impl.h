// SPDX-License-Identifier: MIT
// The state of an asset. pump() chooses what to load while it holds `mutex`, and reads and decodes without
// it.
#pragma once

#include <condition_variable>
#include <mutex>
#include <shared_mutex>

#include "absent_name.h"
#include "distance_store.h"
#include "kelp/simd/clip_tables.h"
#include "level_store.h"

namespace kelp::runtime {

// A request, or the use of a page, counts for so many rounds.
constexpr std::uint32_t kPatience = 8;

// Memory for decoding pages, kept for the next page.
struct Scratch {
  explicit Scratch(const Allocator& allocator) : page(allocator), distances(allocator) {}
  PageData page;
  DistancePage distances;
  Scratch* next = nullptr;
};

// Tells AssetWatch whether the asset lives.
struct Asset::Life {
  std::atomic<std::uint32_t> references{1};
  std::atomic<bool> alive{true};

  void hold() { references.fetch_add(1, std::memory_order_relaxed); }
  void letGo() {
    if (references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
  }
};

struct Asset::Impl {
  Impl(Pack&& opened, const Options& given)
      : pack(std::move(opened)),
        options(given),
        clips(given.allocator),
        absent_clip(given.allocator),
        absent_socket(given.allocator),
        first_level(given.allocator),
        place(given.allocator),
        first_distances(given.allocator),
        distance_place(given.allocator) {}
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  // What to load: a page, or (kGrid) the grid of the level.
  struct Task {
    static constexpr std::uint32_t kGrid = ~0u;
    LevelState* level = nullptr;
    std::uint32_t page = kGrid;
  };
  struct DistanceTask {
    DistanceState* level = nullptr;
    std::uint32_t page = Task::kGrid;
  };
  enum class Wanted : std::uint8_t { kAsked, kAll };
  static constexpr std::uint64_t kAnySize = ~std::uint64_t{0};

  struct Asked {
    Task task;
    float urgency = 0;
  };
  // A page in memory, and the round in which it was last used.
  struct Idle {
    LevelState* level = nullptr;
    std::uint32_t page = 0;
    std::uint32_t used = 0;
  };

  Result<void> prepareLevels();
  Result<void> prepareDistances();
  LevelState* find(int part, int level) const;
  DistanceState* findDistances(int part, int level) const;
  Result<bool> pump(Wanted wanted);
  enum class Step : std::uint8_t { kLoaded, kPostponed, kNothing };
  Result<Step> loadNext(Wanted wanted);
  Result<Step> loadDistances();
  void ask(LevelState& level, float urgency, std::uint32_t now);
  void ask(const LevelState& level, std::uint32_t page, float urgency, std::uint32_t now);

  // Call these with the mutex held.
  void postpone(const Task& task, std::uint64_t reserved);
  void endPass();
  Task choose(Wanted wanted, std::uint64_t below);
  bool isNext(const LevelState& level) const;
  Task firstAbsent(bool coarsest_only, std::uint64_t below);
  Task mostUrgent();
  Task mostUrgentBelow(std::uint64_t below);
  template <class Visit>
  void visitAsked(const Visit& visit);
  void findAsked();
  bool isAbsent(const Task& task) const;
  Task firstNeeded(const Task& task);
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
  void reopenFailed();
  void finish(const Task& task, std::uint64_t reserved, bool done);
  Error fail(const Error& error);
  bool isCoarsestDone();
  bool anyDistancesOpen();
  DistanceTask chooseDistances(std::uint64_t& reserved);
  void setStage(const DistanceTask& task, Stage stage);
  std::uint32_t reopenDistances(Stage from);
  Scratch* takeScratch();
  Result<Step> endTask(Scratch* memory, const Result<void>& done);

  // Call these without it.
  // Makes `memory` if it is null. False: no memory.
  [[nodiscard]] bool makeScratch(Scratch*& memory) const;
  Result<void> loadPage(const Task& task, Scratch*& memory);

  Pack pack;
  Options options;
  simd::ClipTables clips;
  AbsentName absent_clip, absent_socket;
  std::unique_ptr<LevelState[]> states;  // in the order of loading: coarse to fine, then by part
  std::size_t state_count = 0;
  // No level before first_open is open; no coarsest level before first_open_coarsest.
  std::size_t first_open = 0, first_open_coarsest = 0;
  Buffer<std::uint32_t> first_level;  // of each part, into `place`
  Buffer<std::uint32_t> place;        // part-major -> index into `states`
  // The same for the distances that are loaded; others have no place.
  static constexpr std::uint32_t kNoPlace = ~0u;
  std::unique_ptr<DistanceState[]> distances;
  std::size_t distance_count = 0, first_open_distances = 0;
  Buffer<std::uint32_t> first_distances, distance_place;
  bool coarsest_done = false;  // isCoarsestDone() was true

  std::mutex mutex;
  std::condition_variable idle;  // signalled when in_hand becomes 0
  std::uint64_t ended = 0;       // tasks that ended, with or without success
  std::uint32_t in_hand = 0;     // grids and pages that threads are loading now
  std::uint32_t waiting = 0;     // of stage kWaiting
  std::uint64_t postponed = 0;   // how often the source had not got something
  bool some_waited = false;      // the last pass ended with things that the source had not got
  std::uint64_t passes = 0;      // that ended
  bool memory_short = false;     // something that is wanted did not fit into the budget
  Scratch* scratch = nullptr;
  Error first_error;
  bool any_error = false;
  bool retry_wanted = false;  // nothing is begun until nothing is in hand and what failed is absent again
  std::atomic<std::uint64_t> used_bytes{0};
  std::uint64_t page_bytes = 0;  // of these, the pages of levels that are not a coarsest one
  // How many pages findIdle() and findAsked() keep.
  static constexpr std::size_t kKept = 64;
  // [idle_next, idle_count): the pages that were not used for longest, the oldest first.
  Idle idle_pages[kKept];
  std::size_t idle_next = 0, idle_count = 0;
  // [asked_next, asked_count): the most urgent requests, the most urgent first. Stale if `changes` or
  // `round` differ from asked_change and asked_round.
  Asked asked[kKept];
  std::size_t asked_next = 0, asked_count = 0;
  bool asked_all = true;  // the list has everything that was asked for
  std::uint64_t asked_change = 0;
  std::uint32_t asked_round = 0;

  // Counts requests, and everything else that made something ready to load.
  std::atomic<std::uint64_t> changes{1};
  std::atomic<std::uint32_t> round{0};  // of requests; 0: everything is wanted
  std::atomic<bool> driven{false};      // a renderer begins the rounds
  std::shared_mutex readers;            // shared by readers of pages; exclusive while a page is dropped
};

// Access for addClip().
struct ClipReader {
  static const simd::ClipTables& tables(const Asset& asset) { return asset.impl_->clips; }
};

// Access for findClip() and findSocket().
struct NameReader {
  static Error absentClip(const Asset& asset) { return asset.impl_->absent_clip.error(); }
  static Error absentSocket(const Asset& asset) { return asset.impl_->absent_socket.error(); }
};

// Access to distances for queries, without a search.
struct DistanceReader {
  // The level of distances of a part that exists, if it is in memory.
  static const DistanceLevel* level(const Asset& asset, int part, int level) {
    const Asset::Impl& impl = *asset.impl_;
    const std::uint32_t at = impl.distance_place[impl.first_distances[static_cast<std::size_t>(part)] +
                                                 static_cast<std::uint32_t>(level)];
    if (at == Asset::Impl::kNoPlace) return nullptr;
    const DistanceState& state = impl.distances[at];
    return state.ready.load(std::memory_order_acquire) ? &state.data : nullptr;
  }
  // Why none of the part's levels will be in memory before Asset::retry(): the coarsest one's failure. 0:
  // one may still come.
  static std::uint16_t failure(const Asset& asset, int part) {
    const Asset::Impl& impl = *asset.impl_;
    const auto i = static_cast<std::size_t>(part);
    std::uint16_t failure = 0;
    for (std::uint32_t at = impl.first_distances[i]; at < impl.first_distances[i + 1]; ++at) {
      const std::uint32_t place = impl.distance_place[at];
      if (place == Asset::Impl::kNoPlace) continue;
      failure = impl.distances[place].failure.load(std::memory_order_relaxed);
      if (failure == 0) return 0;
    }
    return failure;
  }
  // How many levels there may be; 0: none of them is loaded.
  static int levels(const Asset& asset, int part) {
    const Asset::Impl& impl = *asset.impl_;
    const auto i = static_cast<std::size_t>(part);
    return impl.distance_count == 0 ? 0
                                    : static_cast<int>(impl.first_distances[i + 1] - impl.first_distances[i]);
  }
};

// Gives access to pages, which stay in memory while it lives. Any number at a time, on any threads.
class PageReader {
 public:
  explicit PageReader(const Asset& asset)
      : impl_(*asset.impl_), lock_(asset.impl_->readers), now_(impl_.round.load(std::memory_order_relaxed)) {}

  const LevelState* level(int part, int level) const {
    const LevelState* state = impl_.find(part, level);
    return state && state->ready.load(std::memory_order_acquire) ? state : nullptr;
  }
  // The words of the page. If it is not in memory: null, and the page is requested.
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

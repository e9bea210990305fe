// SPDX-License-Identifier: MIT
// The state of an asset; level.h says how it is streamed.
#pragma once

#include <condition_variable>
#include <mutex>
#include <shared_mutex>

#include "absent_name.h"
#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"
#include "kelp/runtime/pose.h"
#include "kelp/simd/clip_tables.h"
#include "level.h"

namespace kelp::runtime {

// A request, or the use of a page, counts for so many rounds.
constexpr std::uint32_t kPatience = 8;

// Memory for decoding pages, kept for the next page.
struct Scratch {
  explicit Scratch(const Allocator& allocator) : page(allocator) {}
  PageData page;
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
  Impl(Pack&& opened, const AssetOptions& given)
      : pack(std::move(opened)),
        options(given),
        clips(given.allocator),
        name(given.allocator),
        absent_clip(given.allocator),
        absent_part(given.allocator),
        absent_socket(given.allocator),
        absent_joint(given.allocator),
        first_level(given.allocator),
        place(given.allocator) {}
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  // Loads a page, or (kGrid) the grid of the level.
  struct Task {
    static constexpr std::uint32_t kGrid = ~0u;
    LevelState* level = nullptr;
    std::uint32_t page = kGrid;

    Stage& stage() const { return page == kGrid ? level->stage : level->pages[page].stage; }
  };
  enum class Wanted : std::uint8_t { kAsked, kAll };
  enum class Kind : std::uint8_t { kVoxels, kCoarsest, kDistances };  // of levels; the second is of voxels
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
  void addLevels(bool distances);
  // Levels of the part, of distances those that the pack has.
  int levelsOf(int part, bool distances) const;
  // Null: there is none, or it is not to be loaded.
  LevelState* find(int part, int level, bool distances = false) const;
  Result<bool> pump(Wanted wanted);
  enum class Step : std::uint8_t { kLoaded, kPostponed, kNothing };
  Result<Step> loadNext(Wanted wanted);
  void ask(LevelState& level, float urgency, std::uint32_t now);
  void ask(const LevelState& level, std::uint32_t page, float urgency, std::uint32_t now);

  // Call these with the mutex held.
  void endPass();
  Task choose(Wanted wanted, std::uint64_t below);
  bool isNext(const LevelState& level) const;
  Task firstAbsent(Kind kind, std::uint64_t below);
  Task firstDistances(std::uint64_t below);
  Task mostUrgent();
  Task mostUrgentBelow(std::uint64_t below);
  template <class Visit>
  void visitAsked(const Visit& visit);
  void findAsked();
  bool isAbsent(const Task& task) const;
  Task firstNeeded(const Task& task);
  float urgencyOf(const Request& request) const;
  void setStage(const Task& task, Stage stage);
  void noteOpen(LevelState& level);
  template <class Visit>
  void forEachOf(Stage stage, const Visit& visit);
  bool mayGo(const PageSlot& slot) const;
  bool isStillIdle(const Idle& idle) const;
  void findIdle();
  std::uint64_t roomLeft(std::uint64_t enough) const;
  bool makeRoom(std::uint64_t bytes, bool coarsest);
  void evict(LevelState& level, std::uint32_t page);
  std::uint64_t bytesOf(const Task& task) const;
  void reopenFailed();
  void finish(const Task& task, std::uint64_t reserved, const Result<void>& done);
  Error fail(const Error& error);
  bool isCoarsestDone();

  // Call it without.
  Result<void> load(const Task& task, Scratch*& memory);

  Pack pack;
  AssetOptions options;
  simd::ClipTables clips;
  Pose rest;                                 // for parts with cages, made at its first use
  std::atomic<std::uint64_t> rest_bytes{0};  // of it; 0: it is not made
  std::mutex rest_mutex;
  Buffer<char> name;                // of the file, without its folder; empty: opened from a source
  std::atomic<bool> pumped{false};  // pump() or loadAll() was called
  AbsentName absent_clip, absent_part, absent_socket, absent_joint;
  // In the order of loading: voxels, then distances, each coarse to fine, then by part.
  std::unique_ptr<LevelState[]> states;
  std::size_t state_count = 0, voxel_count = 0;
  std::size_t first_open[3] = {};  // [kind]: no level of the kind before it is open
  // [2 part + (1 of distances)]: where the part's levels begin in `place`, and one entry more.
  Buffer<std::uint32_t> first_level;
  Buffer<std::uint32_t> place;  // index into `states`; kNoPlace: distances that are not to be loaded
  static constexpr std::uint32_t kNoPlace = ~0u;
  bool coarsest_done = false;  // isCoarsestDone() was true

  std::mutex mutex;
  std::condition_variable idle;  // signaled when in_hand becomes 0
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
  std::atomic<std::uint64_t> page_bytes{0};  // of these, the pages of levels that are not a coarsest one
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
  static const simd::ClipTables& tables(const Asset& asset) { return asset.impl().clips; }
};

// Access for findClip(), findPart(), findSocket() and findJoint().
struct NameReader {
  static Error absentClip(const Asset& asset) { return asset.impl().absent_clip.error(); }
  static Error absentPart(const Asset& asset) { return asset.impl().absent_part.error(); }
  static Error absentSocket(const Asset& asset) { return asset.impl().absent_socket.error(); }
  static Error absentJoint(const Asset& asset) { return asset.impl().absent_joint.error(); }
};

// Access for posedCage().
struct RestPose {
  // The pose of instances without one. kOutOfMemory.
  static Result<const Pose*> of(const Asset& asset);
};

// Access to distances for queries, without a search.
struct DistanceReader {
  // The level of distances of a part that exists, if it is in memory.
  static const Level* level(const Asset& asset, int part, int level) {
    const LevelState* const state = asset.impl().find(part, level, true);
    return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
  }
  // The ErrorCode because of which none of the part's levels will be in memory before Asset::retry(). 0: one
  // may still come.
  static std::uint16_t failure(const Asset& asset, int part) {
    std::uint16_t failure = 0;
    for (int level = 0; level < levels(asset, part); ++level) {
      const LevelState* const state = asset.impl().find(part, level, true);
      if (!state) continue;
      failure = state->failure.load(std::memory_order_relaxed);
      if (failure == 0) return 0;
    }
    return failure;
  }
  // How many levels there may be; 0: none of them is loaded.
  static int levels(const Asset& asset, int part) {
    const Asset::Impl& impl = asset.impl();
    return impl.state_count > impl.voxel_count ? impl.levelsOf(part, true) : 0;
  }
};

// Gives access to pages, which stay in memory while it lives. Any number at a time, on any threads.
class PageReader {
 public:
  explicit PageReader(const Asset& asset)
      : impl_(asset.impl()), lock_(asset.impl().readers), now_(impl_.round.load(std::memory_order_relaxed)) {}

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
  // Uses all pages of the level that are in memory, so that they stay there: once a round.
  void keep(const LevelState& level) const {
    if (level.kept.exchange(now_, std::memory_order_relaxed) == now_) return;
    for (std::uint32_t page = 0; page < level.data.pages.size(); ++page)
      if (level.pages[page].words.load(std::memory_order_relaxed))
        level.pages[page].used.store(now_, std::memory_order_relaxed);
  }
  // Asks for the first missing pages of a level of which all are wanted, and keeps the others, if all fit
  // into the budget beside those of a level that is in use, and none of them failed.
  void askAhead(const LevelState& level, const LevelState& in_use) const;

 private:
  Asset::Impl& impl_;
  std::shared_lock<std::shared_mutex> lock_;
  std::uint32_t now_;
};

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// One level of one part on its way into memory, and its pages.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "kelp/runtime/asset.h"

namespace kelp::runtime {

enum class Stage : std::uint8_t { kAbsent, kInHand, kResident, kFailed };

// When something was asked for, and how urgently: written by any thread. Whether it is out of reach: written by pump().
struct Request {
  std::atomic<float> urgency{0};
  std::atomic<std::uint32_t> round{0};
  std::atomic<bool> failed{false};

  // The most urgent of a round counts. (Two threads at a time may leave the lesser; the next round asks again.)
  // False: it had been asked for as urgently.
  bool ask(float how_urgently, std::uint32_t now) {
    if (round.load(std::memory_order_relaxed) == now && urgency.load(std::memory_order_relaxed) >= how_urgently) return false;
    urgency.store(how_urgently, std::memory_order_relaxed);
    round.store(now, std::memory_order_relaxed);
    return true;
  }
};

// Levels, and the pages of a level, are kept account of in groups of so many, so that the next to load is found without a look at each.
inline constexpr std::uint32_t kGroup = 256;

// An urgency that nothing below exceeds: no page of a group, nothing of a level, no level of a group. Who asks raises it, afterwards, from the page upwards;
// who looks for the most urgent lowers it, looks, and raises it to what there is. So it may be too high, and never is too low.
class Ceiling {
 public:
  float urgency() const { return urgency_.load(std::memory_order_acquire); }
  // Written even if it stays: what was asked for before is seen by who lowers it after.
  void raise(float urgency) {
    float seen = urgency_.load(std::memory_order_relaxed);
    while (!urgency_.compare_exchange_weak(seen, std::max(seen, urgency), std::memory_order_acq_rel, std::memory_order_relaxed)) {
    }
  }
  void lower() { urgency_.exchange(0, std::memory_order_acq_rel); }

 private:
  std::atomic<float> urgency_{0};
};

struct PageSlot {
  Stage stage = Stage::kAbsent;                 // guarded by the asset's mutex
  std::atomic<std::uint32_t*> words{nullptr};   // null: not resident. Changes to null only while no PageReader lives
  std::atomic<std::uint32_t> pins{0};
  std::atomic<std::uint32_t> used{0};           // round in which it was last looked at
  Request request;
};

struct PageGroup {
  std::uint32_t absent = 0;  // pages; guarded by the asset's mutex
  Ceiling ceiling;
};

// `grid`, `first_*` and `data` are written before `ready` is set, and never after. Stages and counts are guarded by the asset's mutex.
struct LevelState {
  int part = 0;
  int level = 0;
  bool coarsest = false;
  bool open = false;              // something of it is absent: Asset::Impl::noteOpen
  std::uint32_t index = 0;        // in the order of loading
  std::uint64_t grid_raw = 0;     // bytes of the grid's chunk, decoded
  Stage stage = Stage::kAbsent;   // of the grid
  std::uint32_t absent = 0;       // pages
  std::atomic<std::uint32_t> resident{0};
  LevelGrid grid;
  PageSlot* pages = nullptr;      // grid.pages.size() of them, from the allocator
  PageGroup* groups = nullptr;    // of the pages, behind them
  VoxelLevel data;
  std::atomic<bool> ready{false};
  Request request;

  LevelState() = default;
  LevelState(const LevelState&) = delete;
  LevelState& operator=(const LevelState&) = delete;

  // Reads the grid, gives its cells their run-time form, makes the slots of the pages. `ready` is left to the caller.
  Result<void> load(const Pack& pack, const Allocator& allocator);
  void release(const Allocator& allocator);
  std::uint32_t groupCount() const { return (static_cast<std::uint32_t>(grid.pages.size()) + kGroup - 1) / kGroup; }
  // Of grid and slots, before they are read. The pages' own come on top.
  std::uint64_t bytes(const Part& of) const;
};

}  // namespace kelp::runtime

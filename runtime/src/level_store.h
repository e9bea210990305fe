// SPDX-License-Identifier: MIT
// One level of one part on its way into memory, and its pages.
#pragma once

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
  void ask(float how_urgently, std::uint32_t now) {
    if (round.load(std::memory_order_relaxed) == now && urgency.load(std::memory_order_relaxed) >= how_urgently) return;
    urgency.store(how_urgently, std::memory_order_relaxed);
    round.store(now, std::memory_order_relaxed);
  }
};

struct PageSlot {
  Stage stage = Stage::kAbsent;                 // guarded by the asset's mutex
  std::atomic<std::uint32_t*> words{nullptr};   // null: not resident. Changes to null only while no PageReader lives
  std::atomic<std::uint32_t> pins{0};
  std::atomic<std::uint32_t> used{0};           // round in which it was last looked at
  Request request;
};

// `grid`, `first_*` and `data` are written before `ready` is set, and never after. Stages and counts are guarded by the asset's mutex.
struct LevelState {
  int part = 0;
  int level = 0;
  bool coarsest = false;
  std::uint64_t grid_raw = 0;     // bytes of the grid's chunk, decoded
  Stage stage = Stage::kAbsent;   // of the grid
  std::uint32_t absent = 0;       // pages
  std::atomic<std::uint32_t> resident{0};
  LevelGrid grid;
  PageSlot* pages = nullptr;      // grid.pages.size() of them, from the allocator
  VoxelLevel data;
  std::atomic<bool> ready{false};
  Request request;

  LevelState() = default;
  LevelState(const LevelState&) = delete;
  LevelState& operator=(const LevelState&) = delete;

  // Reads the grid, gives its cells their run-time form, makes the slots of the pages. `ready` is left to the caller.
  Result<void> load(const Pack& pack, const Allocator& allocator);
  void release(const Allocator& allocator);
  // Of grid and slots, before they are read. The pages' own come on top.
  std::uint64_t bytes(const Part& of) const;
};

}  // namespace kelp::runtime

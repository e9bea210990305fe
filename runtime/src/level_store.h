// SPDX-License-Identifier: MIT
// One level of one part, and its pages.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "kelp/runtime/asset.h"

namespace kelp::runtime {

// kWaiting: the source has not got it yet, and this pass of pump() does not ask again.
enum class Stage : std::uint8_t { kAbsent, kInHand, kWaiting, kResident, kFailed };

// A request: any thread writes its round and urgency. `failed`: pump() writes whether loading failed.
struct Request {
  std::atomic<float> urgency{0};
  std::atomic<std::uint32_t> round{0};
  std::atomic<bool> failed{false};

  // Keeps the most urgent request of a round. (If two threads race, the less urgent one may stay until the
  // next round.) False if nothing changed.
  bool ask(float how_urgently, std::uint32_t now) {
    if (round.load(std::memory_order_relaxed) == now &&
        urgency.load(std::memory_order_relaxed) >= how_urgently)
      return false;
    urgency.store(how_urgently, std::memory_order_relaxed);
    round.store(now, std::memory_order_relaxed);
    return true;
  }
};

struct PageSlot {
  Stage stage = Stage::kAbsent;  // guarded by the asset's mutex
  bool shaped = false;           // its bricks' shapes are in LevelState::shapes; guarded too
  // Null: not in memory. Changes to null only while no PageReader lives.
  std::atomic<std::uint32_t*> words{nullptr};
  std::atomic<std::uint32_t> pins{0};
  std::atomic<std::uint32_t> used{0};  // the round in which it was last used
  Request request;
};

// `grid` and `data` are written before `ready` is set, and never after. Stages and counts are guarded by the
// mutex of the asset.
struct LevelState {
  int part = 0;
  int level = 0;
  bool coarsest = false;
  bool open = false;               // the grid or a page is absent (Asset::Impl::noteOpen)
  std::uint32_t index = 0;         // in the order of loading
  std::uint64_t grid_raw = 0;      // decoded bytes of the GRID chunk
  Stage stage = Stage::kAbsent;    // of the grid
  std::uint32_t absent = 0;        // pages
  std::uint32_t first_absent = 0;  // no page before it is absent
  std::atomic<std::uint32_t> resident{0};
  LevelGrid grid;
  // What the next finer level is decoded with, one a stored brick; empty if there is none, or of fog. It is
  // never dropped. A page's are written while it is in hand for the first time.
  Buffer<BrickShape> shapes;
  PagesAbove needs;           // pages of the next coarser level; empty if there is none, or of fog
  PageSlot* pages = nullptr;  // grid.pages.size() and that of kSolidBrick, from the allocator
  VoxelLevel data;
  std::atomic<bool> ready{false};
  Request request;

  LevelState() = default;
  LevelState(const LevelState&) = delete;
  LevelState& operator=(const LevelState&) = delete;

  // Reads the grid and makes the slots of the pages. coarser: null if the level is the coarsest. The caller
  // sets `ready`.
  Result<void> load(const Pack& pack, const LevelState* coarser, const Allocator& allocator);
  void release(const Allocator& allocator);
  // Estimates the bytes of grid, shapes and slots before they are read; without the pages.
  std::uint64_t estimatedBytes(const Part& of) const;
  // The bytes of them, once they are there.
  std::uint64_t bytes() const;
};

}  // namespace kelp::runtime

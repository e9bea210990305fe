// SPDX-License-Identifier: MIT
// How an asset is streamed.
//
//   level   One level of one part, of voxels (or fog) or of distances: a grid of cells, and pages that hold
//           the words of its bricks (kelp/formats/page.h). Once the grid is there it stays.
//   page    The unit of reading, decoding, dropping and uploading. Pack::readPage decodes it straight into
//           the words that queries read and a renderer uploads. The level owns them: of voxels a block for
//           each page, of distances one block for all.
//   task    A grid or a page that pump() loads: absent -> in hand -> resident, or failed. If the source has
//           not got it, it waits until the pass ends, then it is absent again.
//
// Order: coarse to fine. A grid needs the next coarser grid, a page of voxels the shapes of the coarser
// voxels around it, which stay when their page is dropped. Distances need nothing, but the coarsest voxels of
// all parts go first.
// Missing: the reader that misses a page asks for it, and coarser voxels stand in for it.
// Damaged: the task fails, and with it all that needs it, until retry(). Everything else goes on.
// Budget: a task reserves its bytes before it begins, of distances a whole level with its grid. Dropped are
// only pages of voxels, not those of a coarsest level, the longest unused first; but no pinned one, and for
// anything but a coarsest level none that was used in the last kPatience rounds. So what is drawn now never
// gives way to what is drawn now, and dropping ends.
//
// Threads: the asset's mutex guards stages and counts; grids and pages are read and decoded without it. What
// is behind `ready` and `words` is written before they are set. Readers hold Asset::Impl::readers shared, or
// a pin, so pump() on one thread drops no page that another draws.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "kelp/formats/level.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/level.h"

namespace kelp::runtime {

enum class Stage : std::uint8_t { kAbsent, kInHand, kWaiting, kResident, kFailed };

// A request: any thread writes its round and urgency.
struct Request {
  std::atomic<float> urgency{0};
  std::atomic<std::uint32_t> round{0};

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
  std::atomic<bool> failed{false};
  // Null: not in memory. Changes to null only while no PageReader lives.
  std::atomic<std::uint32_t*> words{nullptr};
  std::atomic<std::uint32_t> pins{0};
  std::atomic<std::uint32_t> used{0};  // the round in which it was last used
  Request request;
};

struct LevelState {
  int part = 0;
  int level = 0;
  bool distances = false;
  bool coarsest = false;           // of voxels
  bool open = false;               // the grid or a page is absent (Asset::Impl::noteOpen)
  LevelState* coarser = nullptr;   // the next one of its kind; null: there is none
  std::uint32_t index = 0;         // in the order of loading
  std::uint64_t grid_raw = 0;      // decoded bytes of its grid's chunk
  Stage stage = Stage::kAbsent;    // of the grid
  std::uint32_t absent = 0;        // pages
  std::uint32_t first_absent = 0;  // no page before it is absent
  std::atomic<std::uint32_t> resident{0};
  std::uint64_t page_bytes = 0;  // of all pages
  // For PageReader::keep() and askAhead(): the round in which all pages were last used; no page before this
  // one is missing.
  mutable std::atomic<std::uint32_t> kept{~0u}, first_missing{0};
  // The ErrorCode because of which the grid, or something of a level of distances, is not there; 0: none.
  std::atomic<std::uint16_t> failure{0};
  LevelGrid grid;
  // Of voxels: what the next finer level is decoded with, one a stored brick; empty if there is none. A
  // page's are written while it is in hand for the first time.
  Buffer<BrickShape> shapes;
  PagesAbove needs;                   // of voxels: pages of the next coarser level; empty if there is none
  Buffer<std::uint32_t> words;        // of distances: all pages
  Buffer<std::uint32_t> first_slots;  // of distances: of each page
  PageSlot* pages = nullptr;          // grid.pages.size() and that of kSolidBrick, from the allocator
  Level data;
  std::atomic<bool> ready{false};  // of voxels: the grid is there; of distances: everything is
  Request request;

  LevelState() = default;
  LevelState(const LevelState&) = delete;
  LevelState& operator=(const LevelState&) = delete;

  bool dropsPages() const { return !distances && !coarsest; }
  std::uint64_t pageBytes(std::uint32_t page) const {
    return std::uint64_t{pageWords(grid.pages[page])} * sizeof(std::uint32_t);
  }
  // Reads the grid and makes the slots of the pages. The caller sets `ready`.
  Result<void> load(const Pack& pack, const Allocator& allocator);
  // Reads a page. `memory`: for decoding.
  Result<void> loadPage(const Pack& pack, std::uint32_t page, std::uint32_t round, PageData& memory,
                        const Allocator& allocator);
  // Gives all pages and slots back.
  void release(const Allocator& allocator);
  // Estimates the bytes that load() takes before the grid is read: without the pages of voxels, but with
  // those of distances, of which it is at least as much as they take.
  std::uint64_t estimatedBytes(const Part& of) const;
  // These bytes, once the grid is there.
  std::uint64_t bytes() const;
};

}  // namespace kelp::runtime

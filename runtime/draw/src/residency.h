// SPDX-License-Identifier: MIT
// Which grids and pages of the host's assets are in the pool, and which should be: their priority is how many
// pixels the voxels in their place cover.
#pragma once

#include <algorithm>
#include <memory>

#include "copies.h"
#include "resident_asset.h"

namespace kelp::draw {

// Bytes of an upload() that are kept back for the tables that a transfer changes at its end.
inline constexpr std::uint64_t kReserve = 256;

class Residency {
 public:
  // distances: whether those that assets load belong into the pool.
  Residency(const Allocator& allocator, bool distances)
      : distances_(distances),
        pool_(allocator),
        copies_(allocator),
        pins_(allocator),
        changes_(allocator),
        assets_(allocator),
        victims_(allocator),
        queue_(allocator) {}
  Residency(const Residency&) = delete;
  Residency& operator=(const Residency&) = delete;
  ~Residency();

  Result<void> create(std::uint64_t pool_bytes);
  Result<void> add(const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);

  // Begins a draw; the first one after an upload() forgets what earlier ones asked for.
  void beginWants();
  static void want(ResidentPart& part, int level, float pixels) {
    Want& want = part.want;
    want.level = want.asked ? std::min(want.level, level) : level;
    want.pixels = std::max(want.pixels, pixels);
    want.asked = true;
  }

  struct Progress {
    std::uint64_t bytes = 0;    // uploaded
    std::uint32_t pending = 0;  // grids and pages that are wanted, would fit, and are not in the pool
    bool coarsest_fit = true;   // of all assets
  };
  // Copies at most `max_bytes`, asks the assets for what is not in memory.
  Result<Progress> upload(std::uint64_t max_bytes);
  // Of the last create(), add() or upload(). They do not overlap.
  std::span<const Copy> copies();
  // Lets go of the pages that they are from.
  void copied();

  // Index for at(), or -1. Does not access the asset, which may be destroyed: see alive().
  int find(const runtime::Asset* asset) const;
  bool uploaded() const { return uploaded_; }
  bool alive(int index) const { return at(index).watch.alive(); }
  ResidentAsset& at(int index) const { return *assets_[static_cast<std::size_t>(index)]; }
  const Pool& pool() const { return pool_; }
  // Progress::pending of the last upload(), and all levels of assets that were added since.
  std::uint32_t pending() const { return pending_; }

 private:
  // The upload in progress, over several frames if needed.
  struct Transfer {
    ResidentLevel* level = nullptr;  // null: nothing
    std::uint32_t page = Pool::Block::kGrid;
    std::uint32_t row = 0;
    std::uint64_t done = 0;   // words
    std::uint64_t frame = 0;  // Copy::frame
  };
  std::size_t lowerBound(const runtime::Asset* asset) const;
  // Words of the pool that a level's pages changed: of its page table, or (kTable) its words in the asset's
  // tables. They are copied at the end of the call, as they are then.
  struct Change {
    static constexpr std::uint32_t kTable = ~0u;
    ResidentLevel* level;
    std::uint32_t first, count;
    std::uint64_t address;  // where that is; 0: its grid was dropped
  };
  // A page that a copy is from.
  struct Pin {
    const ResidentAsset* asset;
    void* pin;
  };
  void beginCall(std::uint64_t max_bytes);
  void unpin(const ResidentAsset* asset);
  Result<void> prioritize();
  bool advance(ResidentLevel& level);
  bool begin(ResidentLevel& level, std::uint32_t page, std::uint32_t rows);
  bool proceed();
  void finish();
  void cancel();
  std::uint32_t makeRoom(std::uint32_t rows, float priority);
  void dropPage(ResidentLevel& level, std::uint32_t page);
  void dropGrid(ResidentLevel& level);
  // Room for so many more changes, of so many words together, and a copy. False: no memory.
  [[nodiscard]] bool reserve(std::size_t changes, std::uint64_t words);
  void copy(std::uint64_t address, std::span<const std::uint32_t> words, std::uint64_t frame);
  void change(ResidentLevel& level, std::uint32_t first, std::uint32_t count);
  void changeTable(ResidentLevel& level);
  std::uint64_t addressOf(const Change& change) const;
  void copyChanges();
  void forget(ResidentAsset& asset);
  void forgetDead();

  const bool distances_;
  Pool pool_;
  Copies copies_;
  Buffer<Pin> pins_;  // the first pin_count_
  std::size_t pin_count_ = 0;
  Buffer<Change> changes_;  // the first change_count_, until copyChanges()
  std::size_t change_count_ = 0;
  std::uint64_t change_words_ = 0;
  std::uint64_t written_ = 0;  // bytes: of the copies, and of the changes
  std::size_t count_ = 0;
  Buffer<ResidentAsset*> assets_;  // the first count_, ascending by address; owned
  Buffer<Pool::Block> victims_;
  Transfer transfer_;
  std::uint64_t last_number_ = 0;  // of an asset
  std::uint32_t round_ = 0;        // of upload()
  bool uploaded_ = false;          // upload() may have sent something
  bool drawn_ = false;             // before the first draw everything is wanted
  bool wants_read_ = true;

  std::uint32_t pending_ = 0;
  // Of the upload() that runs.
  Buffer<ResidentLevel*> queue_;  // the first queued_, the most urgent first
  std::size_t queued_ = 0;
  std::uint64_t byte_limit_ = 0;  // of written_
  std::uint64_t rows_left_ = 0;   // of the pool, left for less urgent levels
  std::uint32_t too_many_ = ~0u;  // so many rows and more are not available
  bool later_ = false;            // the frame's bytes were used up while making room
  bool coarsest_fit_ = true;
};

}  // namespace kelp::draw

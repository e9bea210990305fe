// SPDX-License-Identifier: MIT
// Which grids and pages of the host's assets are in the pool, and which should be: their priority is how many
// pixels the voxels in their place cover.
#pragma once

#include <algorithm>
#include <memory>

#include "resident_asset.h"

namespace kelp::gl {

// Bytes of an upload() that are kept back for the tables that a transfer changes at its end.
inline constexpr std::uint64_t kReserve = 256;

class Residency {
 public:
  // distances: whether those that assets load belong into the pool.
  Residency(const Allocator& allocator, bool distances)
      : distances_(distances), pool_(allocator), assets_(allocator), victims_(allocator), queue_(allocator) {}
  Residency(const Residency&) = delete;
  Residency& operator=(const Residency&) = delete;
  ~Residency();

  Result<void> create(const Api& api, std::uint64_t budget) { return pool_.create(api, budget); }
  // Deletes the texture, or (no api) forgets it, and all assets.
  void clear(const Api* api);

  // Within an UploadGuard.
  Result<void> add(const Api& api, const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);

  // Call it before the first draw after an upload(): it forgets what earlier draws asked for.
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
  // Uploads at most `max_bytes`, asks the assets for what is not in memory. Within an UploadGuard.
  Result<Progress> upload(const Api& api, std::uint64_t max_bytes);

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
    std::uint64_t done = 0;  // words
  };
  std::size_t lowerBound(const runtime::Asset* asset) const;
  Result<void> prioritize();
  bool advance(const Api& api, ResidentLevel& level);
  bool begin(const Api& api, ResidentLevel& level, std::uint32_t page, std::uint32_t rows);
  bool proceed(const Api& api);
  void finish(const Api& api);
  void cancel();
  std::uint32_t makeRoom(const Api& api, std::uint32_t rows, float priority);
  void dropPage(const Api& api, ResidentLevel& level, std::uint32_t page);
  void dropGrid(const Api& api, ResidentLevel& level);
  void writeTable(const Api& api, const ResidentLevel& level);
  void forget(ResidentAsset& asset);

  const bool distances_;
  Pool pool_;
  std::size_t count_ = 0;
  Buffer<ResidentAsset*> assets_;  // the first count_, ascending by address; owned
  Buffer<Pool::Block> victims_;
  Transfer transfer_;
  std::uint32_t round_ = 0;  // of upload()
  bool uploaded_ = false;    // upload() may have sent something
  bool drawn_ = false;       // before the first draw everything is wanted
  bool wants_read_ = true;

  std::uint32_t pending_ = 0;
  // Of the upload() that runs.
  Buffer<ResidentLevel*> queue_;  // the first queued_, the most urgent first
  std::size_t queued_ = 0;
  std::uint64_t byte_limit_ = 0;  // of pool_.written()
  std::uint64_t rows_left_ = 0;   // of the pool, left for less urgent levels
  std::uint32_t too_many_ = ~0u;  // so many rows and more are not available
  bool later_ = false;            // the frame's bytes were used up while making room
  bool coarsest_fit_ = true;
};

}  // namespace kelp::gl

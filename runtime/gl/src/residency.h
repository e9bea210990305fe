// SPDX-License-Identifier: MIT
// What of the host's assets is in the pool, and what should be: grids and pages come and go by how many pixels they are worth.
#pragma once

#include <algorithm>
#include <memory>

#include "kelp/runtime/asset.h"
#include "pool.h"

namespace kelp::gl {

struct ResidentAsset;

// One level of one part in the pool.
struct ResidentLevel {
  ResidentAsset* asset = nullptr;
  std::int32_t part = 0;
  std::int32_t level = 0;
  glm::ivec3 grid{0};              // bricks
  std::uint32_t table = 0;         // its three words in the asset's tables: shaders/instance.glsl
  float priority = 0;              // > 0: wanted; the pixels that a voxel of the next coarser level covers. < 0: rounds since it was wanted
  float recent = 0;                // its highest priority in this age: Residency::prioritise
  float peak = 0;                  // in all ages since it was last worth much less
  std::uint32_t dropped = 0;       // round in which it last gave way
  std::uint8_t quiet = 0;          // ages in which it was worth much less than its peak
  std::uint8_t patience = 0;       // so many ages may be quiet; twice as many each time that it came back soon
  bool restless = false;           // it came back soon
  float worth = 0;                 // it gives way to what is worth more: its priority, or, restless, its peak
  std::uint32_t grid_row = 0;      // 0: not in the pool
  std::uint32_t resident = 0;      // pages
  std::uint32_t all_rows = 0;      // of all its pages
  Buffer<std::uint32_t> page_rows;  // 0: not in the pool. Empty while the grid is not

  std::uint64_t cellsAt() const { return std::uint64_t{grid_row} * Pool::kRowWords; }
  bool complete() const { return grid_row != 0 && resident == page_rows.size(); }
};

// What of a part the frame's draws asked for.
struct Want {
  float pixels = 0;        // that a level-0 voxel covers, at most
  std::int32_t level = 0;  // the finest that is of use
  bool asked = false;
};

struct ResidentPart {
  std::uint32_t first_level = 0;  // in ResidentAsset::levels
  std::int32_t levels = 0;
  std::int32_t finest = 0;        // whose grid, and those of all coarser ones, are in the pool; equal to `levels`: the part can not be drawn
  Want want;
  glm::vec4 extent{0};            // size, level-0 voxels; levels
  std::uint32_t table = 0;        // that of its finest level
};

struct ResidentAsset {
  const runtime::Asset* asset = nullptr;
  runtime::AssetWatch watch;
  std::span<const Part> packed;   // the asset's own
  std::uint32_t tables_row = 0;
  Buffer<ResidentPart> parts;
  Buffer<ResidentLevel*> levels;  // part by part, finest first; owned

  ResidentAsset() = default;
  ResidentAsset(const ResidentAsset&) = delete;
  ResidentAsset& operator=(const ResidentAsset&) = delete;
  ~ResidentAsset();

  std::uint32_t palette() const { return tables_row * Pool::kRowWords; }
  ResidentLevel& level(const ResidentPart& part, int level) const { return *levels[part.first_level + static_cast<std::size_t>(level)]; }
};

// What whoever holds the block is worth; blocks of tables and of what is being uploaded have no holder.
float worthOf(const Pool::Block& block);

class Residency {
 public:
  explicit Residency(const Allocator& allocator)
      : pool_(allocator), assets_(allocator), victims_(allocator), queue_(allocator) {}
  Residency(const Residency&) = delete;
  Residency& operator=(const Residency&) = delete;
  ~Residency();

  Result<void> create(const Api& api, std::uint64_t budget) { return pool_.create(api, budget); }
  // Deletes the texture, or (no api) forgets it, and all assets.
  void clear(const Api* api);

  // Within an UploadGuard.
  Result<void> add(const Api& api, const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);

  // Before the first draw after an upload(): what earlier draws asked for no longer counts.
  void beginWants();
  static void want(ResidentPart& part, int level, float pixels) {
    Want& want = part.want;
    want.level = want.asked ? std::min(want.level, level) : level;
    want.pixels = std::max(want.pixels, pixels);
    want.asked = true;
  }

  struct Progress {
    std::uint64_t bytes = 0;     // uploaded
    std::uint32_t pending = 0;   // grids and pages that are wanted, would fit, and are not in the pool
    bool coarsest_fit = true;    // of all assets
  };
  // Uploads at most `max_bytes`, asks the assets for what is not in memory. Within an UploadGuard.
  Result<Progress> upload(const Api& api, std::uint64_t max_bytes);

  // Index for at(), or -1. Does not touch the asset, which may be gone: `alive` says.
  int find(const runtime::Asset* asset) const;
  bool alive(int index) const { return at(index).watch.alive(); }
  ResidentAsset& at(int index) const { return *assets_[static_cast<std::size_t>(index)]; }
  const Pool& pool() const { return pool_; }

 private:
  // What is being uploaded, over as many frames as its bytes take.
  struct Transfer {
    ResidentLevel* level = nullptr;  // null: nothing
    std::uint32_t page = Pool::Block::kGrid;
    std::uint32_t row = 0;
    std::uint64_t done = 0;          // words
  };
  std::size_t lowerBound(const runtime::Asset* asset) const;
  Result<void> prioritise();
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

  Pool pool_;
  std::size_t count_ = 0;
  Buffer<ResidentAsset*> assets_;  // the first count_, ascending by address; owned
  Buffer<Pool::Block> victims_;
  Transfer transfer_;
  std::uint32_t round_ = 0;  // of upload()
  bool drawn_ = false;       // until the first draw everything is wanted
  bool wants_read_ = true;

  // Of the upload() that runs.
  Buffer<ResidentLevel*> queue_;   // the first queued_, the most urgent first
  std::size_t queued_ = 0;
  std::uint64_t byte_limit_ = 0;   // of pool_.written()
  std::uint64_t rows_left_ = 0;    // of the pool, for what is less urgent than all that was looked at
  std::uint32_t too_many_ = ~0u;   // as many rows were not to be had
  std::uint32_t pending_ = 0;
  bool later_ = false;             // the frame's bytes ended while room was made
  bool coarsest_fit_ = true;
};

}  // namespace kelp::gl

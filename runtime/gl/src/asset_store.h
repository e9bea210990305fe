// SPDX-License-Identifier: MIT
// What of the host's assets is on the GPU: found by address, filled level by level, within a budget.
#pragma once

#include <memory>

#include "level_textures.h"

namespace kelp::gl {

struct GpuPart {
  std::uint32_t first_level = 0;  // in GpuAsset::levels
  std::int32_t levels = 0;
  std::int32_t finest = 0;        // finest level on the GPU; equal to `levels`: none
  bool refused = false;           // the next finer level does not go onto this GPU
};

struct GpuAsset {
  const runtime::Asset* asset = nullptr;
  Name palette = 0;
  std::uint64_t bytes = 0;
  Buffer<GpuPart> parts;
  Buffer<LevelTextures> levels;  // part by part, finest first

  const LevelTextures& level(int part, int level) const {
    return levels[parts[static_cast<std::size_t>(part)].first_level + static_cast<std::size_t>(level)];
  }
};

class AssetStore {
 public:
  AssetStore(const Allocator& allocator, std::uint64_t budget) : allocator_(allocator), budget_(budget), assets_(allocator), scratch_(allocator) {}
  AssetStore(const AssetStore&) = delete;
  AssetStore& operator=(const AssetStore&) = delete;

  // Within an UploadGuard.
  Result<void> add(const Api& api, const runtime::Asset& asset);
  void remove(const Api& api, const runtime::Asset& asset);
  // Uploads coarse to fine, at least one level, until `max_bytes` are reached; answers the bytes. A level that this GPU can not hold is
  // answered once, after the rest was tried, and its part stays at the coarser level; one over the budget is answered every time.
  Result<std::uint64_t> upload(const Api& api, std::uint64_t max_bytes);

  // Deletes everything, or (no api) forgets it.
  void clear(const Api* api);

  // Index for at(), or -1.
  int find(const runtime::Asset* asset) const;
  const GpuAsset& at(int index) const { return *assets_[static_cast<std::size_t>(index)]; }
  std::uint64_t bytes() const { return bytes_; }
  // Levels in memory and not on the GPU.
  std::uint32_t pending() const;

 private:
  std::size_t lowerBound(const runtime::Asset* asset) const;

  Allocator allocator_;
  std::uint64_t budget_;
  std::uint64_t bytes_ = 0;
  std::size_t count_ = 0;
  Buffer<GpuAsset*> assets_;  // the first count_, ascending by address
  Buffer<std::uint32_t> scratch_;
};

}  // namespace kelp::gl

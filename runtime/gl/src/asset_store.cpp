// SPDX-License-Identifier: MIT
#include "asset_store.h"

#include <algorithm>
#include <functional>
#include <new>

#include "kelp/formats/brick.h"

namespace kelp::gl {
namespace {

constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory to keep account of an asset"};

void deleteTextures(const Api& api, GpuAsset& asset) {
  for (LevelTextures& level : asset.levels) deleteLevel(api, level);
  api.DeleteTextures(1, &asset.palette);
}

}  // namespace

std::size_t AssetStore::lowerBound(const runtime::Asset* asset) const {
  const auto before = [](const GpuAsset* known, const runtime::Asset* wanted) { return std::less<>()(known->asset, wanted); };
  return static_cast<std::size_t>(std::lower_bound(assets_.begin(), assets_.begin() + count_, asset, before) - assets_.begin());
}

int AssetStore::find(const runtime::Asset* asset) const {
  const std::size_t place = lowerBound(asset);
  return place < count_ && assets_[place]->asset == asset ? static_cast<int>(place) : -1;
}

Result<void> AssetStore::add(const Api& api, const runtime::Asset& asset) {
  if (find(&asset) >= 0) return Error{ErrorCode::kMisuse, "the asset is known already"};
  const std::span<const Part> parts = asset.pack().parts();
  std::unique_ptr<GpuAsset> fresh(new (std::nothrow) GpuAsset{&asset, 0, 0, Buffer<GpuPart>(allocator_), Buffer<LevelTextures>(allocator_)});
  if (!fresh || !fresh->parts.reset(parts.size())) return kNoMemory;
  std::uint32_t levels = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    fresh->parts[i] = {levels, parts[i].levels, parts[i].levels, false};
    levels += static_cast<std::uint32_t>(parts[i].levels);
  }
  if (!fresh->levels.reset(levels)) return kNoMemory;

  if (count_ == assets_.size()) {
    Buffer<GpuAsset*> more(allocator_);
    if (!more.reset(std::max<std::size_t>(16, 2 * count_))) return kNoMemory;
    std::copy(assets_.begin(), assets_.end(), more.begin());
    assets_ = std::move(more);
  }
  const std::span<const Material> palette = asset.pack().palette();
  if (bytes_ + paletteBytes(palette) > budget_) return Error{ErrorCode::kLimit, "gpu_budget is used up"};
  auto texture = uploadPalette(api, palette);
  if (!texture) return texture.error();
  fresh->palette = *texture;
  fresh->bytes = paletteBytes(palette);
  bytes_ += fresh->bytes;

  const std::size_t place = lowerBound(&asset);
  std::copy_backward(assets_.begin() + place, assets_.begin() + count_, assets_.begin() + count_ + 1);
  assets_[place] = fresh.release();
  ++count_;
  return {};
}

void AssetStore::remove(const Api& api, const runtime::Asset& asset) {
  const int index = find(&asset);
  if (index < 0) return;
  const auto place = static_cast<std::size_t>(index);
  const std::unique_ptr<GpuAsset> gone(assets_[place]);
  deleteTextures(api, *gone);
  bytes_ -= gone->bytes;
  std::copy(assets_.begin() + place + 1, assets_.begin() + count_, assets_.begin() + place);
  --count_;
}

Result<std::uint64_t> AssetStore::upload(const Api& api, std::uint64_t max_bytes) {
  std::uint64_t done = 0;
  bool failed = false;
  Error first_error;
  const auto refuse = [&](GpuPart& part, const Error& error, bool for_good) {
    part.refused = for_good;
    if (!failed) first_error = error;
    failed = true;
  };
  for (int level = kMaxLevels - 1; level >= 0; --level) {
    for (GpuAsset* asset : std::span(assets_.data(), count_)) {
      for (std::size_t p = 0; p < asset->parts.size(); ++p) {
        GpuPart& part = asset->parts[p];
        if (part.refused || part.finest != level + 1) continue;
        const runtime::LevelData* data = asset->asset->level(static_cast<int>(p), level);
        if (!data) continue;
        const auto layout = layOut(api, *data);
        if (!layout) {
          refuse(part, layout.error(), true);
          continue;
        }
        if (bytes_ + layout->bytes > budget_) {
          refuse(part, {ErrorCode::kLimit, "gpu_budget is used up"}, false);
          continue;
        }
        if (done > 0 && done + layout->bytes > max_bytes) {
          if (failed) return first_error;
          return done;
        }
        const auto textures = uploadLevel(api, *data, *layout, scratch_);
        if (!textures) {
          refuse(part, textures.error(), true);
          continue;
        }
        asset->levels[part.first_level + static_cast<std::size_t>(level)] = *textures;
        part.finest = level;
        asset->bytes += textures->bytes;
        bytes_ += textures->bytes;
        done += textures->bytes;
      }
    }
  }
  if (failed) return first_error;
  return done;
}

void AssetStore::clear(const Api* api) {
  for (GpuAsset* asset : std::span(assets_.data(), count_)) {
    const std::unique_ptr<GpuAsset> gone(asset);
    if (api) deleteTextures(*api, *gone);
  }
  count_ = 0;
  bytes_ = 0;
}

std::uint32_t AssetStore::pending() const {
  std::uint32_t count = 0;
  for (const GpuAsset* asset : std::span(assets_.data(), count_)) {
    for (std::size_t p = 0; p < asset->parts.size(); ++p) {
      const GpuPart& part = asset->parts[p];
      for (int level = part.finest - 1; level >= 0 && !part.refused; --level) {
        if (!asset->asset->level(static_cast<int>(p), level)) break;
        ++count;
      }
    }
  }
  return count;
}

}  // namespace kelp::gl

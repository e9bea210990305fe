// SPDX-License-Identifier: MIT
// For renderers, besides an asset's public functions: rounds of requests, pages that stay in memory, and
// whether the asset still exists. Any thread may call any function at any time while the asset exists.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "kelp/runtime/asset.h"
#include "kelp/runtime/level.h"

namespace kelp::runtime {

// Keeps a page of bricks in memory while it lives. Movable. Destroy it before the asset.
class PinnedPage {
 public:
  PinnedPage() = default;
  PinnedPage(PinnedPage&& other) noexcept;
  PinnedPage& operator=(PinnedPage&& other) noexcept;
  ~PinnedPage();

  explicit operator bool() const { return pins_ != nullptr; }
  std::span<const std::uint32_t> words() const { return words_; }  // kelp/formats/page.h

 private:
  friend struct PageAccess;
  std::span<const std::uint32_t> words_;
  void* pins_ = nullptr;
};

// Tells whether an asset still exists, for code that keeps a pointer to it. Copyable; usable on any thread.
class AssetWatch {
 public:
  AssetWatch() = default;
  explicit AssetWatch(const Asset& asset);
  AssetWatch(const AssetWatch& other);
  AssetWatch& operator=(const AssetWatch& other);
  ~AssetWatch();

  bool alive() const;

 private:
  Asset::Life* life_ = nullptr;
};

struct LevelId {
  int part = 0;
  int level = 0;
  bool distances = false;
};

// A request ends eight rounds after it was last made, and a page that was not used for eight rounds may make
// room. urgency > 0; the most urgent is loaded first. Wrong indices are ignored. Levels of distances come
// without being requested, and are never dropped.
struct PageAccess {
  // Starts a round. From then on the caller drives the asset's rounds; pump() starts none by itself.
  static void beginRequests(const Asset& asset);
  // The name of the asset's file, without its folder. "an asset" if it was opened from a source.
  static const char* name(const Asset& asset);
  // False: neither pump() nor loadAll() was called.
  static bool wasPumped(const Asset& asset);
  // Asset::level() or Asset::distances().
  static const Level* level(const Asset& asset, const LevelId& id);
  // Requests the grid of a level.
  static void request(const Asset& asset, const LevelId& id, float urgency);
  // The page if it is in memory. Else an empty PinnedPage, and the page is requested.
  static PinnedPage pin(const Asset& asset, const LevelId& id, std::uint32_t page, float urgency);
  // Takes over what keeps a page in memory; unpin() lets it go, unless the asset is gone.
  static void* take(PinnedPage page) { return std::exchange(page.pins_, nullptr); }
  static void unpin(void* taken);
  // True if the grid, or the page, cannot be loaded before the next retry(): loading it failed, or the asset
  // has no such level.
  static bool hasFailed(const Asset& asset, const LevelId& id);
  static bool hasFailed(const Asset& asset, const LevelId& id, std::uint32_t page);
};

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// A pack in memory. Opening it reads some kilobytes. Then pump() loads its voxels page by page, coarse to
// fine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "kelp/formats/pack.h"
#include "kelp/runtime/page.h"

namespace kelp::runtime {

// One level of one part, without its voxels. Immutable; valid as long as the asset.
struct VoxelLevel {
  glm::ivec3 size{0};                    // voxels of this level
  glm::ivec3 grid{0};                    // bricks
  std::span<const std::uint32_t> cells;  // one a brick, x fastest, then y, then z (kelp/runtime/page.h)
  std::span<const PageInfo> pages;       // they hold the stored bricks
};

struct Options {
  Limits limits;
  // For grids, pages and decoding. Some hundred bytes for each level of each part come from operator new.
  Allocator allocator;
  // The most bytes of grids and pages to keep in memory. When they are used up, the pages that were not used
  // for longest make room. The coarsest level of each part is never dropped. Pages used in the last eight
  // rounds (beginRequests()) are dropped only for a coarsest level. If rays use more than the budget holds, a
  // renderer draws coarser pages until those rays stop.
  std::uint64_t memory_budget = std::uint64_t{1} << 30;
};

// Keeps a page of bricks in memory while it lives. Movable. Destroy it before the asset.
class PinnedPage {
 public:
  PinnedPage() = default;
  PinnedPage(PinnedPage&& other) noexcept;
  PinnedPage& operator=(PinnedPage&& other) noexcept;
  ~PinnedPage();

  explicit operator bool() const { return pins_ != nullptr; }
  std::span<const std::uint32_t> words() const { return words_; }  // kelp/runtime/page.h

 private:
  friend class Asset;
  std::span<const std::uint32_t> words_;
  void* pins_ = nullptr;
};

// Tells whether an asset still exists, for code that keeps a pointer to it. Copyable; usable on any thread.
class AssetWatch {
 public:
  AssetWatch() = default;
  AssetWatch(const AssetWatch& other);
  AssetWatch& operator=(const AssetWatch& other);
  ~AssetWatch();

  bool alive() const;

 private:
  friend class Asset;
  struct Life;
  explicit AssetWatch(Life* life);  // takes over a reference
  Life* life_ = nullptr;
};

// Owns the decoded voxels. Thread-safe: any thread may call any function at any time; only the destructor
// must come last. Starts no threads: the host calls pump() from its jobs or from a thread of its own.
//
// What is loaded: until the first request (a renderer requests in every upload()), everything, coarse to
// fine. After it, only what was requested recently, the most urgent first, and always the coarsest level of
// each part.
class Asset {
 public:
  // Reads and checks everything except the voxels: a few kilobytes. The source's `user` must outlive the
  // asset. Errors of Pack::open, and kOutOfMemory. Safe for hostile packs.
  static Result<std::unique_ptr<Asset>> open(const Source& source, const Options& options = {});
  ~Asset();
  Asset(const Asset&) = delete;
  Asset& operator=(const Asset&) = delete;

  const Pack& pack() const;

  // Reads and decodes the most urgent grid or page. Blocks while the source reads. True: something was
  // loaded, call again. False: nothing that fits is wanted now, or other threads are loading it; call again
  // later. An error (the pack is damaged, the source cannot read, memory is short) is returned once, with its
  // place in the pack. That grid or page, and everything that needs it, stays absent until retry(), and
  // coarser voxels are drawn instead. The next pump() goes on with the rest.
  Result<bool> pump();
  // Loads everything, requested or not, and waits for what other threads are loading. Returns the first error
  // of any grid or page, including errors of other threads; everything else is loaded all the same. kLimit if
  // memory_budget is too small for everything.
  Result<void> loadAll();
  // Tries again what failed. Call it when a source that could not read can read again.
  void retry();

  // The level, if its grid and those of all coarser levels are loaded; else null.
  const VoxelLevel* level(int part, int level) const;
  // The finest level of the part that is wholly in memory and not finer than `wanted`. If there is none, the
  // coarsest of the finer ones. -1: none yet.
  int residentLevel(int part, int wanted = 0) const;
  // Bytes of grids and pages that are in memory now.
  std::uint64_t memory() const;
  AssetWatch watch() const;

  // Requests. Renderers make them. A host without a renderer whose memory budget is smaller than the pack
  // calls beginRequests() once a tick; raycast() then requests what it needs. A request ends eight rounds
  // after it was last made, and a page that was not used for eight rounds may make room. urgency > 0; the
  // most urgent is loaded first; for example, the number of pixels that would change. Wrong indices are
  // ignored.
  void beginRequests() const;                              // starts a round
  void request(int part, int level, float urgency) const;  // requests the grid of a level
  // The page if it is in memory. Else an empty PinnedPage, and the page is requested.
  PinnedPage pin(int part, int level, std::uint32_t page, float urgency) const;
  // Whether loading the grid, or the page, failed since the last retry().
  bool hasFailed(int part, int level) const;
  bool hasFailed(int part, int level, std::uint32_t page) const;

 private:
  friend struct ClipReader;
  friend class PageReader;
  struct Impl;
  Asset(std::unique_ptr<Impl> impl, const AssetWatch& watch);
  std::unique_ptr<Impl> impl_;
  AssetWatch watch_;
};

}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// A pack in memory: opened in an instant, filled page by page, coarse to fine, by whoever calls pump().
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "kelp/formats/pack.h"
#include "kelp/runtime/page.h"

namespace kelp::runtime {

// One level of one part, all but its voxels. Immutable once handed out; good as long as the asset.
struct VoxelLevel {
  glm::ivec3 size{0};                       // voxels of this level
  glm::ivec3 grid{0};                       // bricks
  std::span<const std::uint32_t> cells;     // one a brick, x fastest, then y, then z: kelp/runtime/page.h
  std::span<const PageInfo> pages;          // which hold the stored bricks
};

struct Options {
  Limits limits;
  Allocator allocator;  // for grids, pages and what decodes them: all but some hundred bytes for each level of each part
  // Bytes of grids and pages that are kept in memory, at most. When it is used up, the pages that nobody asked for or looked at for longest
  // make room. The coarsest level of each part is never dropped. Nor is what rays look at all the time: where they look at more than the budget
  // leaves, a renderer waits for its pages, and draws coarser ones, until they rest.
  std::uint64_t memory_budget = std::uint64_t{1} << 30;
};

// A page of bricks that stays in memory while this lives. Movable; let go of it before the asset goes.
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

// Tells whether an asset is still there, without touching it: for those that keep a pointer to it. Copyable; any thread.
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
  explicit AssetWatch(Life* life);  // takes a reference over
  Life* life_ = nullptr;
};

// Owns the decoded voxels. Thread-safe: any thread may call any function at any time, except that the destructor must come last.
// No threads of its own: a host calls pump() from its jobs, or starts one thread that does.
//
// What is loaded: until somebody asks for something (a renderer does, in every upload()), everything, coarse to fine. From then on what was
// asked for lately, the most urgent first, and always the coarsest level of each part.
class Asset {
 public:
  // Reads and checks everything but the voxels: a few kilobytes. The source's `user` must outlive the asset. Hostile packs are safe.
  static Result<std::unique_ptr<Asset>> open(const Source& source, const Options& options = {});
  ~Asset();
  Asset(const Asset&) = delete;
  Asset& operator=(const Asset&) = delete;

  const Pack& pack() const;

  // Reads and decodes one grid or one page, the most urgent. True: something was done, call again. False: nothing is wanted now that there
  // is room for, or other threads have it in hand.
  // After an error (the pack is damaged, the source could not read, memory is short) what was to be loaded stays absent, and what rests on
  // it: coarser voxels are drawn in its place. The error is answered once, with the place in the pack, and pump() goes on with the rest.
  Result<bool> pump();
  // pump() until everything is resident, asked for or not, waiting for what other threads have in hand. Answers the first error of any page,
  // also one that another thread's pump() met; what could be loaded is resident all the same. kLimit: memory_budget is too small for everything.
  Result<void> loadAll();
  // What failed is wanted again: after a source that could not read can.
  void retry();

  // The level's grid if it has been loaded, and those of all coarser levels; else null.
  const VoxelLevel* level(int part, int level) const;
  // The finest level of the part that is wholly resident and at least as coarse as `wanted`; failing that the finest there is; -1: none yet.
  int residentLevel(int part, int wanted = 0) const;
  // Bytes of grids and pages in memory now.
  std::uint64_t memory() const;
  AssetWatch watch() const;

  // For renderers, and for a host that only asks rays (raycast() asks for what it lacks) in less memory than the pack takes: it calls
  // beginRequests() once a tick. Requests age: what was not asked for again in the last eight rounds is no longer wanted, and what was not
  // looked at in them may make room. `urgency` > 0, the greater the sooner; pixels that change when it is there, say. Wrong indices ask for nothing.
  void beginRequests() const;  // a new round
  void request(int part, int level, float urgency) const;  // the level's grid
  // The page if it is resident; else null, and it is asked for.
  PinnedPage pin(int part, int level, std::uint32_t page, float urgency) const;
  // Whether the grid, or the page, could not be loaded; until retry().
  bool hasFailed(int part, int level) const;
  bool hasFailed(int part, int level, std::uint32_t page) const;

 private:
  friend class PageReader;
  struct Impl;
  Asset(std::unique_ptr<Impl> impl, const AssetWatch& watch);
  std::unique_ptr<Impl> impl_;
  AssetWatch watch_;
};

}  // namespace kelp::runtime

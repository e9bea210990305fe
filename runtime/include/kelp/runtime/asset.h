// SPDX-License-Identifier: MIT
// A pack in memory. Opening it reads some kilobytes. Then pump() loads its voxels page by page, coarse to
// fine.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kelp/formats/pack.h"

namespace kelp::runtime {

struct Level;  // kelp/runtime/level.h

struct AssetOptions {
  PackLimits limits;
  // For grids, pages and decoding. Some hundred bytes for each level of each part come from operator new.
  Allocator allocator;
  // The most bytes of grids and pages to keep in memory. When they are used up, the pages that were not used
  // for longest make room. The coarsest level of each part is never dropped. Pages used in the last eight
  // rounds are dropped only for a coarsest level. A round is an upload() of a renderer; without a renderer, a
  // pump() that found nothing to do. If rays use more than the budget holds, a renderer draws coarser pages
  // until those rays stop.
  std::uint64_t memory_budget = std::uint64_t{1} << 30;
  // The finest level of distances to load, for the queries of kelp/runtime/distance.h. 0: all of them; empty:
  // none, and nothing of them is read. Of a part with fewer levels the coarsest is loaded.
  std::optional<int> distance_level = std::nullopt;
};

// Owns the decoded voxels. Thread-safe: any thread may call any function at any time; only the destructor
// must come last. Starts no threads: the host calls pump() from its jobs or from a thread of its own.
//
// Loading: at first everything, coarse to fine. Once a renderer has called upload(), or the memory
// budget is used up, only what was requested recently, by draws and ray casts, the most urgent first, and
// always the coarsest level of each part. Distances come after these coarsest levels and before everything
// else, each level whole or not at all, and are never dropped.
//
// Lifetimes: an asset keeps its source alive if the source says how (Source::acquire), as
// FileSource does. Poses and springs need no asset once they are made. An Instance only points: its asset and
// its poses must live during the calls that take it. Remove an asset from its renderers before it is
// destroyed; a renderer finds out otherwise, and refuses its instances (kMisuse).
class Asset {
 public:
  // Reads and checks everything except the voxels: a few kilobytes. Errors of Pack::open, and kOutOfMemory.
  // kNotYet: the source has not got them; open it again later. Safe for hostile packs.
  static Result<std::unique_ptr<Asset>> open(const Source& source, const AssetOptions& options = {});
  // Opens a file, which stays open as long as the asset lives. Errors of FileSource::open, too.
  static Result<std::unique_ptr<Asset>> open(const char* path, const AssetOptions& options = {});
  ~Asset();
  Asset(const Asset&) = delete;
  Asset& operator=(const Asset&) = delete;

  const Pack& pack() const;

  // Reads and decodes the most urgent grid or page that the source has. Blocks while the source reads, so not
  // at all if the source answers kNotYet instead. True: something was loaded, call again. False: nothing that
  // fits is wanted now, or other threads are loading it, or the source has not got it yet; call again later,
  // in the next frame or after some milliseconds. Each such pass asks the source once for each thing that is
  // wanted. An error (the pack is damaged, the source cannot read, memory is short) is returned once, with
  // its place in the pack. That grid or page, and everything that needs it, stays absent until retry(), and
  // coarser voxels are drawn instead. The next pump() goes on with the rest.
  Result<bool> pump();
  // Loads everything, requested or not, and waits for what other threads are loading. Returns the first error
  // of any grid or page, including errors of other threads; everything else is loaded all the same. kLimit if
  // memory_budget is too small for everything. kNotYet if the source has not got the rest: call again later.
  Result<void> loadAll();
  // Tries again what failed, once what other threads are loading has ended. Call it when a source that could
  // not read can read again.
  void retry();

  // The level, if its grid and those of all coarser levels are loaded; else null.
  const Level* level(int part, int level) const;
  // The finest level of the part that is wholly in memory and not finer than `wanted`. If there is none, the
  // coarsest of the finer ones. nullopt: none yet, or no such part.
  std::optional<int> residentLevel(int part, int wanted = 0) const;
  // The level of distances, if all of it is in memory; else null. Needs AssetOptions::distance_level. Where
  // the budget does not hold a level, coarser ones are there; loadAll() says so, pump() does not.
  const Level* distances(int part, int level) const;
  // True if the asset loads distances: it was asked to, and the pack has some.
  bool loadsDistances() const;
  // Bytes of grids, pages and distances that are in memory now, and, beside the budget, of what instances
  // without a pose need for cages.
  std::uint64_t memory() const;

  // For kelp's own libraries, which know what these are.
  struct Impl;
  struct Life;
  Impl& impl() const { return *impl_; }
  Life* life() const { return life_; }

 private:
  Asset(std::unique_ptr<Impl> impl, Life* life);
  std::unique_ptr<Impl> impl_;
  Life* life_;  // counts who watches, and outlives this
};

}  // namespace kelp::runtime

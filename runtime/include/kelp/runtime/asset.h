// SPDX-License-Identifier: MIT
// A pack in memory: opened in an instant, filled level by level, coarse to fine, by whoever calls pump().
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "kelp/formats/pack.h"

namespace kelp::runtime {

// The voxels of one level of one part, as the tracer reads them (see kelp/formats/brick.h). Immutable once handed out.
struct LevelData {
  glm::ivec3 size{0};                       // voxels of this level
  glm::ivec3 grid{0};                       // bricks
  std::span<const std::uint32_t> cells;     // one a brick
  std::span<const std::uint8_t> codes;      // 512 a slot
  std::span<const std::uint32_t> slice_base;  // 8 a slot: index of the first attribute of each z-slice
  std::span<const std::uint32_t> attributes;
};

struct Options {
  Limits limits;
  Allocator allocator;  // for all memory whose size depends on the pack
};

// Owns the decoded voxels. Thread-safe: any thread may call any function at any time, except that the destructor must come last.
// No threads of its own: a host calls pump() from its jobs, or starts one thread that does.
class Asset {
 public:
  // Reads and checks everything but the voxels: a few kilobytes. The source's `user` must outlive the asset. Hostile packs are safe.
  static Result<std::unique_ptr<Asset>> open(const Source& source, const Options& options = {});
  ~Asset();
  Asset(const Asset&) = delete;
  Asset& operator=(const Asset&) = delete;

  const Pack& pack() const;

  // Reads and decodes one page (or one grid) of the coarsest level that is not complete. True: something was done, call again.
  // False: nothing is wanted now (everything is resident, or other threads have the last pages in hand).
  // After an error (the pack is damaged, or memory is short) that level and the finer ones of its part stay absent; the error is answered
  // once, and pump() goes on with the rest.
  Result<bool> pump();
  // pump() until everything is resident, waiting for pages that other threads have in hand. Answers the first error of any level, also one
  // that another thread's pump() met; what could be loaded is resident all the same.
  Result<void> loadAll();

  // The level if all of it is resident, else null. The pointer stays good as long as the asset.
  const LevelData* level(int part, int level) const;
  // The finest resident level of the part that is at least as coarse as `wanted`; failing that the finest there is; -1: none yet.
  int residentLevel(int part, int wanted = 0) const;

 private:
  struct Impl;
  explicit Asset(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kelp::runtime

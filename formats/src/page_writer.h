// SPDX-License-Identifier: MIT
// Levels -> pages of bricks -> their bytes, on several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "kelp/formats/buffer.h"
#include "kelp/formats/raw_pack.h"
#include "voxels.h"

namespace kelp {

// Bytes as they are in the file.
struct Packed {
  Buffer<std::byte> stored;
  std::uint64_t checksum = 0;
  std::uint64_t raw = 0;
  bool compressed = false;
};

// A level to write: of voxels or of fog, or else of distances.
struct LevelPlan {
  std::size_t index = 0, part = 0;
  const RawLevel* raw = nullptr;
  const RawDistances* distances = nullptr;
  const RawLevel* above = nullptr;  // of voxels: the next coarser one; null: there is none
  Lattice lattice;
  std::size_t palette = 0;    // entries
  Buffer<glm::ivec3> bricks;  // the stored ones, by slot
  std::size_t pages = 0;

  std::span<const std::uint32_t> cells() const { return raw ? raw->cells : distances->cells; }
};

// The bricks of one page.
struct PagePlan {
  const LevelPlan* level = nullptr;
  std::uint32_t first_slot = 0;
  std::uint32_t count = 0;
  std::uint64_t first_attribute = 0;
  std::uint32_t attributes = 0;
};

// Distributes the bricks of a level to pages, in order, as many to a page as fit. Writes them to `pages`
// unless it is empty. Returns the number of pages.
std::size_t planPages(const LevelPlan& level, std::span<PagePlan> pages);

// Compresses every page. `packed` has one entry a page. The bytes do not depend on `threads`. kOutOfMemory;
// kMisuse if codes of distances are impossible, or voxels contradict those of the next coarser level.
Result<void> packPages(std::span<const PagePlan> pages, std::span<Packed> packed, int threads, Effort effort);

// Compresses the bytes if that makes them smaller. False if memory is short.
[[nodiscard]] bool packBytes(std::span<const std::byte> bytes, Packed& packed);

}  // namespace kelp

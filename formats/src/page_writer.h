// SPDX-License-Identifier: MIT
// Levels -> pages of bricks -> their bytes, on several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "distance_pages.h"
#include "kelp/formats/buffer.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// Bytes as they are in the file.
struct Packed {
  Buffer<std::byte> stored;
  std::uint64_t checksum = 0;
  std::uint64_t raw = 0;
  bool compressed = false;
};

// A level of voxels or of fog to write.
struct LevelPlan {
  const RawLevel* raw = nullptr;
  const RawLevel* above = nullptr;  // of voxels: the next coarser one; null: there is none
  glm::ivec3 size{0};               // in voxels
  std::size_t palette = 0;          // entries
  Buffer<glm::ivec3> bricks;        // the stored ones, by slot
};

// The bricks of one page: of a level of voxels, or of distances.
struct PagePlan {
  const LevelPlan* level = nullptr;
  const DistanceLevel* distances = nullptr;
  const std::uint8_t* codes = nullptr;  // of the first brick of the page; of distances only
  std::uint32_t first_slot = 0;
  std::uint32_t count = 0;
  std::uint64_t first_attribute = 0;
  std::uint32_t attributes = 0;
};

// Distributes the bricks of a level to pages, in order, as many to a page as fit. Writes them to `pages`
// unless it is empty. Returns the number of pages.
std::size_t planPages(const LevelPlan& level, std::span<PagePlan> pages);
// The same for distances, whose 512 codes for each brick are `codes`.
std::size_t planPages(const DistanceLevel& level, std::span<const std::uint8_t> codes,
                      std::span<PagePlan> pages);

// Compresses every page. `packed` has one entry a page. The bytes do not depend on `threads`. kOutOfMemory;
// kMisuse if codes of distances are impossible, or voxels contradict those of the next coarser level.
Result<void> packPages(std::span<const PagePlan> pages, std::span<Packed> packed, int threads, Effort effort);

// Compresses the bytes if that makes them smaller. False if memory is short.
[[nodiscard]] bool packBytes(std::span<const std::byte> bytes, Packed& packed);

}  // namespace kelp

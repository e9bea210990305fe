// SPDX-License-Identifier: MIT
// Levels -> pages of bricks -> zstd frames, on several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "kelp/formats/buffer.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// A block of bytes as the file will hold it.
struct Packed {
  Buffer<std::byte> stored;
  std::uint64_t checksum = 0;
  std::uint64_t raw = 0;
  bool compressed = false;
};

// Some bricks of a level that travel together.
struct PagePlan {
  const RawLevel* level = nullptr;
  std::uint32_t first_slot = 0;
  std::uint32_t count = 0;
  std::uint64_t first_attribute = 0;
  std::uint32_t attributes = 0;
};

// Shares the bricks of a level out, in order, as many to a page as fit. Answers the number of pages; `pages`, unless it is empty,
// receives them.
std::size_t planPages(const RawLevel& level, std::span<PagePlan> pages);

// Compresses every page; packed has one entry a page. False when memory is short. The bytes do not depend on `threads`.
[[nodiscard]] bool packPages(std::span<const PagePlan> pages, std::span<Packed> packed, int threads);

// Compresses bytes if that makes them smaller. False when memory is short.
[[nodiscard]] bool packBytes(std::span<const std::byte> bytes, Packed& packed);

}  // namespace kelp

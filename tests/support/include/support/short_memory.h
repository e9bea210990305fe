// SPDX-License-Identifier: MIT
// Memory that gives out, and that counts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "kelp/formats/pack.h"

namespace kelp::test {

// Refuses the n-th request, and those after it or not.
struct ShortMemory {
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();
  std::size_t refuse_at = kNever;
  bool and_on = true;
  std::size_t requests = 0, live = 0, live_bytes = 0, peak_bytes = 0;

  Allocator allocator() {
    Allocator result;
    result.user = this;
    result.allocate = [](void* user, std::size_t bytes) -> void* {
      ShortMemory& self = *static_cast<ShortMemory*>(user);
      const std::size_t request = self.requests++;
      if (request == self.refuse_at || (self.and_on && request > self.refuse_at)) return nullptr;
      ++self.live;
      self.live_bytes += bytes;
      self.peak_bytes = std::max(self.peak_bytes, self.live_bytes);
      return std::malloc(bytes);
    };
    result.deallocate = [](void* user, void* memory, std::size_t bytes) {
      ShortMemory& self = *static_cast<ShortMemory*>(user);
      --self.live;
      self.live_bytes -= bytes;
      std::free(memory);
    };
    return result;
  }
};

// The memory that PackLimits (kelp/formats/pack.h) allow for a file of so many bytes: for an open pack, one
// of its grids and one of its pages together.
inline std::uint64_t mostMemory(const PackLimits& limits, std::uint64_t file_bytes) {
  constexpr std::uint64_t kQuarter = std::uint64_t{1} << 18;
  const std::uint64_t decoded = std::min(limits.max_decoded_bytes, 32768 * file_bytes);
  return 2 * limits.max_metadata_bytes + 2 * file_bytes + kQuarter + decoded * 9 / 4 + file_bytes + kQuarter +
         2 * kQuarter;
}

}  // namespace kelp::test

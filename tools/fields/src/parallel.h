// SPDX-License-Identifier: MIT
// How large a piece of a loop is worth a thread's waking.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "kelp/common/parallel.h"

namespace kelp::fields {

// Calls body(begin, end) for disjoint ranges that cover [0, count), on up to `threads` threads (less than 1:
// one for each of the machine). Ranges hold at least `grain` items, except the last, and each thread gets
// about eight: few enough that a body may allocate scratch memory, enough that one slow range does not keep
// the other threads waiting. What a body throws is thrown here, once.
template <class Body>
void parallelFor(std::int64_t count, std::int64_t grain, int threads, const Body& body) {
  constexpr std::int64_t kRangesOfThread = 8;
  const std::int64_t range =
      std::max({std::int64_t{1}, grain, count / (kRangesOfThread * threadCount(threads))});
  parallelRanges(static_cast<std::size_t>(std::max<std::int64_t>(count, 0)), static_cast<std::size_t>(range),
                 threads, [&](std::size_t begin, std::size_t end) {
                   body(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end));
                 });
}

// Items of so many voxels each that make a piece worth a thread's waking.
inline std::int64_t grainOf(std::int64_t voxels_per_item) {
  return 16384 / (voxels_per_item > 0 ? voxels_per_item : 1) + 1;
}

}  // namespace kelp::fields

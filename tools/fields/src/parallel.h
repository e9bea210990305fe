// SPDX-License-Identifier: MIT
// Loops over independent pieces of work. Two implementations, one linked: parallel_tbb.cpp where TBB is found,
// parallel_threads.cpp else.
#pragma once

#include <cstdint>
#include <functional>

namespace kelp::fields {

// Calls body(begin, end) for disjoint ranges that cover [0, count), on up to `threads` threads (less than 1: as many as the
// machine has), the calling one among them. Ranges hold at least `grain` items but for the last. What a body throws is thrown
// here, once.
void parallelFor(std::int64_t count, std::int64_t grain, int threads,
                 const std::function<void(std::int64_t begin, std::int64_t end)>& body);

// Items of so many voxels each that make a piece worth a thread's waking.
inline std::int64_t grainOf(std::int64_t voxels_per_item) { return 16384 / (voxels_per_item > 0 ? voxels_per_item : 1) + 1; }

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
// Loops over independent pieces of work. Two implementations, one linked: parallel_tbb.cpp where TBB is found, parallel_threads.cpp else.
#pragma once

#include <cstdint>
#include <functional>

namespace kelp::fields {

// Calls body(begin, end) for disjoint ranges that cover [0, count), on up to `threads` threads (less than 1: as many as the machine has),
// the calling one among them. Ranges hold at least `grain` items but for the last. What a body throws is thrown here, once.
void parallelFor(std::int64_t count, std::int64_t grain, int threads, const std::function<void(std::int64_t begin, std::int64_t end)>& body);

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
// How much memory this program has from operator new, and the most it had since it was asked to forget.
#pragma once

#include <cstddef>

// The thread sanitizer does not let operator new be replaced: nothing is counted there.
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define KELP_THREAD_SANITIZER
#endif
#endif

namespace kelp::test {

// Bytes now, from which peakAllocated() counts on.
std::size_t resetPeakAllocated();
std::size_t peakAllocated();

}  // namespace kelp::test

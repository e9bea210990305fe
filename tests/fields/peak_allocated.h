// SPDX-License-Identifier: MIT
// How much memory this program has from operator new, and the most it had since it was asked to forget.
#pragma once

#include <cstddef>

namespace kelp::test {

// Bytes now, from which peakAllocated() counts on.
std::size_t resetPeakAllocated();
std::size_t peakAllocated();

}  // namespace kelp::test

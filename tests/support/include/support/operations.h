// SPDX-License-Identifier: MIT
// Counts operations instead of seconds: how often code of a counted library enters a basic block. The count
// is the same on every run and every machine, so a test can say how it grows. See kelp_counted() in
// tools/cmake.
#pragma once

#include <cstdint>

namespace kelp::test {

// Blocks that the calling thread entered so far in counted code.
std::uint64_t operationsSoFar();

template <class Work>
std::uint64_t operationsOf(const Work& work) {
  const std::uint64_t before = operationsSoFar();
  work();
  return operationsSoFar() - before;
}

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// What -fsanitize-coverage=trace-pc calls at every basic block.
#include "support/operations.h"

namespace {

thread_local std::uint64_t g_operations = 0;

}  // namespace

extern "C" void __sanitizer_cov_trace_pc() { ++g_operations; }

namespace kelp::test {

std::uint64_t operationsSoFar() { return g_operations; }

}  // namespace kelp::test

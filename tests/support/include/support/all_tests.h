// SPDX-License-Identifier: MIT
// Whether a test should try all that it can: with KELP_ALL_TESTS set, as tests/run.sh --all does. Without, it takes some of it, a few seconds' worth.
#pragma once

#include <cstdlib>

namespace kelp::test {

inline bool allTests() { return std::getenv("KELP_ALL_TESTS") != nullptr; }

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Whether a test should try all that it can: with KELP_ALL_TESTS set, as tests/run.sh --all does. Without, it takes some of it, a few seconds' worth.
#pragma once

#include <cstdlib>

namespace kelp::test {

inline bool allTests() { return std::getenv("KELP_ALL_TESTS") != nullptr; }

// Under a sanitizer, where everything takes several times as long: what tries many thousands of random cases then tries fewer. Other presets try them all.
#if defined(__has_feature)
constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool kSanitized = false;
#endif

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// True if a test should try all cases: with KELP_ALL_TESTS set, as tests/run.sh --all does. Without, it takes
// some seconds' worth of them.
#pragma once

#include <cstdlib>

namespace kelp::test {

inline bool allTests() { return std::getenv("KELP_ALL_TESTS") != nullptr; }

// Under a sanitizer, where everything takes several times as long, tests of many like cases try a share of
// them: run.sh has another preset that tries them all.
#if defined(__has_feature)
constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool kSanitized = false;
#endif
#ifdef __EMSCRIPTEN__
constexpr bool kThreads = false;  // tests cannot start any
#else
constexpr bool kThreads = true;
#endif
constexpr int shareOf(int cases) { return kSanitized ? (cases + 5) / 6 : cases; }

}  // namespace kelp::test

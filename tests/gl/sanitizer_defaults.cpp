// SPDX-License-Identifier: MIT
// Checks that sanitizers leave out in programs that draw by Mesa, which is not instrumented. Their
// runtimes call these functions, where there is one.

// Mesa keeps some memory for ever, and the search for leaks fails where its threads are at their end. What
// kelp takes is counted by its own allocator (memory_test.cpp).
extern "C" __attribute__((visibility("default"))) const char* __asan_default_options() {
  return "detect_leaks=0";
}

// The atomic counters by which Mesa's threads agree are not seen. Two accesses in kelp are never hidden by
// this; one in kelp and one in Mesa are.
extern "C" __attribute__((visibility("default"))) const char* __tsan_default_suppressions() {
  return "race:swrast_dri.so\n"
         "race:libgallium\n";
}

// SPDX-License-Identifier: MIT
// What the thread sanitizer is not to report: the inside of Mesa, which is not instrumented, so that the atomic counters by which its threads
// agree are not seen. Two accesses in kelp are never hidden by this; one in kelp and one in Mesa are.

// Called by the sanitizer's runtime, if there is one.
extern "C" __attribute__((visibility("default"))) const char* __tsan_default_suppressions() {
  return "race:swrast_dri.so\n"
         "race:libgallium\n";
}

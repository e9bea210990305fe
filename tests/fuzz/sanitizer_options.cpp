// SPDX-License-Identifier: MIT
// Defaults of the sanitizers: any undefined behavior ends the run, and so does a single allocation of more
// than kelp promises for hostile input. A small quarantine leaves the memory limit to the code under test.
extern "C" {
const char* __asan_default_options();
const char* __ubsan_default_options();

__attribute__((visibility("default"), used)) const char* __asan_default_options() {
  return "max_allocation_size_mb=1024:allocator_may_return_null=0:quarantine_size_mb=32";
}
__attribute__((visibility("default"), used)) const char* __ubsan_default_options() {
  return "halt_on_error=1:print_stacktrace=1";
}
}

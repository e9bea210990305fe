// SPDX-License-Identifier: MIT
// Replaces operator new for the whole program. A file of its own: where the compiler sees both, it takes new
// and free for a mismatch.
#include "count_new.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<long> calls{0};
}

void* operator new(std::size_t size) {
  ++calls;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++calls;
  return std::malloc(size ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace kelp::test {
long newCalls() { return calls; }
}  // namespace kelp::test

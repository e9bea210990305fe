// SPDX-License-Identifier: MIT
#include "peak_allocated.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#ifdef _WIN32
#define malloc_usable_size _msize
#endif

namespace {
std::atomic<std::size_t> now{0}, peak{0};
}  // namespace

namespace kelp::test {

std::size_t resetPeakAllocated() {
  peak = now.load();
  return peak;
}
std::size_t peakAllocated() { return peak; }

}  // namespace kelp::test

#ifndef KELP_THREAD_SANITIZER
void* operator new(std::size_t size) {
  void* const p = std::malloc(size ? size : 1);
  if (!p) throw std::bad_alloc();
  const std::size_t sum = now += malloc_usable_size(p);
  for (std::size_t seen = peak; sum > seen && !peak.compare_exchange_weak(seen, sum);) {
  }
  return p;
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* p) noexcept {
  if (p) now -= malloc_usable_size(p);
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept { operator delete(p); }
#endif

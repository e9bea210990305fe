// SPDX-License-Identifier: MIT
#include "watched_gl.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string_view>

#include "gl_api.h"
#include "support/egl_context.h"

namespace kelp::test {
namespace {

// All relaxed, and no question to EGL, which locks: counting must not put the threads in an order that they
// would not have without it, or the thread sanitizer sees no race.
constexpr auto kRelaxed = std::memory_order_relaxed;
std::atomic<long> calls_made{0}, stray_calls{0};
thread_local bool is_gl_thread = false;

// A function of the table, by its member of Api: counts, then calls EGL's, which serves every context.
template <auto kMember>
struct Watched;
template <class R, class... Arguments, R (KELP_GL_CALL* gl::Api::*kMember)(Arguments...)>
struct Watched<kMember> {
  static inline std::atomic<R(KELP_GL_CALL*)(Arguments...)> real = nullptr;
  static R KELP_GL_CALL call(Arguments... arguments) {
    calls_made.fetch_add(1, kRelaxed);
    if (!is_gl_thread) stray_calls.fetch_add(1, kRelaxed);
    return real.load(kRelaxed)(arguments...);
  }
  static void* watch(void* address) {
    if (!address) return nullptr;
    real.store(reinterpret_cast<R(KELP_GL_CALL*)(Arguments...)>(address), kRelaxed);
    return reinterpret_cast<void*>(&call);
  }
};

}  // namespace

void* WatchedGl::getProcAddress(void*, const char* name) {
  const std::string_view wanted(name);
  void* const address = EglContext::getProcAddress(nullptr, name);
#define KELP_WATCH(result, function, parameters) \
  if (wanted == "gl" #function) return Watched<&gl::Api::function>::watch(address);
  KELP_GL_FUNCTIONS(KELP_WATCH)
  KELP_GL_DESKTOP_FUNCTIONS(KELP_WATCH)
  KELP_GL_BLEND_FUNCTIONS(KELP_WATCH)
  KELP_GL_DEBUG_FUNCTIONS(KELP_WATCH)
#undef KELP_WATCH
#define KELP_WATCH(result, function, parameters) \
  if (wanted == "gl" #function "KHR") return Watched<&gl::Api::function>::watch(address);
  KELP_GL_DEBUG_FUNCTIONS(KELP_WATCH)
#undef KELP_WATCH
  if (wanted == "eglGetCurrentContext") return address;
  ADD_FAILURE() << name << " is not in the table, and so not watched";
  return address;
}

void WatchedGl::enterGlThread() { is_gl_thread = true; }
long WatchedGl::calls() { return calls_made; }
long WatchedGl::strayCalls() { return stray_calls; }

}  // namespace kelp::test

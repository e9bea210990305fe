// SPDX-License-Identifier: MIT
// The only file of formats that is compiled with exceptions: std::thread throws if there are no more
// threads. Emscripten has threads only in programs that are compiled for them as a whole.
#include "worker_threads.h"

#include <thread>
#include <vector>

namespace kelp {

#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
void runOnThreads(int, void (*work)(void* user), void* user) { work(user); }
#else
void runOnThreads(int threads, void (*work)(void* user), void* user) {
  std::vector<std::thread> others;
  try {
    others.reserve(static_cast<std::size_t>(threads > 1 ? threads - 1 : 0));
    for (int i = 1; i < threads; ++i) others.emplace_back(work, user);
  } catch (...) {
    // The threads that started, and this one, do the work.
  }
  work(user);
  for (std::thread& thread : others) thread.join();
}
#endif

}  // namespace kelp

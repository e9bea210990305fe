// SPDX-License-Identifier: MIT
// Ranges of work on several threads. The result of a range must not depend on the thread that runs it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "kelp/common/progress.h"

namespace kelp {

inline int threadCount(int asked) {
  return asked > 0 ? asked : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

// Calls work(begin, end) for ranges of at most `grain` items that cover [0, count), on `threads` threads (0:
// one for each core). This thread is one of them, and only it calls `step`. The first exception ends the work
// and is thrown again here.
template <class Work>
void parallelRanges(std::size_t count, std::size_t grain, int threads, const Work& work,
                    const Step& step = {}) {
  const std::size_t ranges = (count + grain - 1) / grain;
  const std::size_t workers = std::min<std::size_t>(static_cast<std::size_t>(threadCount(threads)), ranges);
  if (workers <= 1) {
    for (std::size_t begin = 0; begin < count; begin += grain) {
      work(begin, std::min(count, begin + grain));
      if (step) step(static_cast<double>(std::min(count, begin + grain)) / static_cast<double>(count));
    }
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto run = [&](const Step& tell) {
    try {
      for (std::size_t range = next++; range < ranges; range = next++) {
        work(range * grain, std::min(count, (range + 1) * grain));
        if (tell) tell(static_cast<double>(range + 1) / static_cast<double>(ranges));
      }
    } catch (...) {
      next = ranges;
      const std::lock_guard<std::mutex> lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::thread> pool;
  try {
    for (std::size_t i = 1; i < workers; ++i) pool.emplace_back(run, Step());
  } catch (const std::system_error&) {  // No more threads can be started: those that run do all the work.
  }
  run(step);
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace kelp

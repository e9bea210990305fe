// SPDX-License-Identifier: MIT
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "parallel.h"

namespace kelp::fields {

void parallelFor(std::int64_t count, std::int64_t grain, int threads,
                 const std::function<void(std::int64_t, std::int64_t)>& body) {
  if (count <= 0) return;
  grain = std::max<std::int64_t>(grain, 1);
  if (threads == 1 || count <= grain) return body(0, count);
  // TBB has no more workers than the machine has threads, and says so on stderr when asked for more.
  const int most = tbb::info::default_concurrency();
  tbb::task_arena arena(threads < 1 ? most : std::min(threads, most));
  arena.execute([&] {
    // blocked_range splits above its grain size and may leave halves below it: twice the grain keeps every range at or above it.
    const tbb::blocked_range<std::int64_t> all(0, count, static_cast<std::size_t>(2 * grain));
    tbb::parallel_for(all, [&](const tbb::blocked_range<std::int64_t>& range) { body(range.begin(), range.end()); });
  });
}

}  // namespace kelp::fields

// SPDX-License-Identifier: MIT
// The CPU's results for the rays of a view: which meet the deformed box, the hits of the C++ build of
// trace.glsl, and the ground truth.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "bench_trace_gpu.h"
#include "reference/judge.h"

namespace kelp::bench {

struct RayCheck {
  bool meets_box = false;                 // the deformed box itself, not its bounds; double precision
  Count cpp;                              // trace.glsl in C++
  std::optional<reference::Truth> truth;  // of every n-th ray
};

// One for each ray; every `nth` is given its truth, none if nth is 0.
std::vector<RayCheck> checkRays(const PosedItem& item, const Rays& rays, int nth, int threads);

// work(i) for i in [0, count), on some threads.
void parallelFor(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace kelp::bench

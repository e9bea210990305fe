// SPDX-License-Identifier: MIT
// Millions of random rays against the ground truth, on the CPU: the scenes' volumes and made ones from 256 to
// 4096 voxels, sheared, again as many through swept ones to 2048, and through caged ones.
#pragma once

#include <cstdint>
#include <vector>

#include "bench_trace_scenes.h"

namespace kelp::bench {

// Prints a line for each volume. Answers whether nothing was missed and nothing invented.
bool runLong(const std::vector<Scene>& scenes, std::uint64_t rays, int threads);

}  // namespace kelp::bench

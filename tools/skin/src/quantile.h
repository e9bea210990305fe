// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace kelp::bake {

// The least value that, with those below it, has this share of the weight. At least one value.
inline double weightedQuantile(const std::vector<double>& values, const std::vector<double>& weights,
                               double share) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] < values[b] || (values[a] == values[b] && a < b);
  });
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  double below = 0;
  for (const std::size_t i : order) {
    below += weights[i];
    if (below >= wanted) return values[i];
  }
  return values[order.back()];
}

}  // namespace kelp::bake

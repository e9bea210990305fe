// SPDX-License-Identifier: MIT
#include "batch/shard.h"

#include <algorithm>
#include <numeric>
#include <queue>

namespace kelp::bake_cli {

double voxelsOf(const Options& options) {
  const double side = options.settings.resolution;
  return side * side * side;
}

std::vector<std::size_t> chooseShard(const std::vector<Options>& assets, const Shard& shard) {
  std::vector<std::size_t> order(assets.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return assets[a].settings.resolution > assets[b].settings.resolution;
  });
  struct Load {
    double voxels;
    unsigned index;
    // The queue's top is the least; of equals the first.
    bool operator<(const Load& other) const {
      return voxels != other.voxels ? voxels > other.voxels : index > other.index;
    }
  };
  std::priority_queue<Load> loads;
  for (unsigned i = 1; i <= shard.count; ++i) loads.push({0, i});
  std::vector<std::size_t> chosen;
  for (const std::size_t asset : order) {
    Load load = loads.top();
    loads.pop();
    if (load.index == shard.index) chosen.push_back(asset);
    load.voxels += voxelsOf(assets[asset]);
    loads.push(load);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
// Which parts are joined.
#include <algorithm>
#include <map>
#include <utility>

#include "kelp/common/parallel.h"
#include "partition.h"

namespace kelp::bake {

void Partition::merge() {
  struct Pair {
    std::uint32_t a = 0, b = 0;
    double width = 0, gain = 0;  // of the seam; of the energy, if the two are joined
  };
  const auto costOfAll = [&](PartMotion motion, const std::vector<std::uint32_t>& members) {
    double sum = 0;
    for (const std::uint32_t i : members) {
      motion.prepareFor(i, samples_, moments_);
      sum += samples_.areas[i] * (motion.cost(i, samples_) + constants_[i]);
    }
    return sum;
  };
  constexpr int kPasses = 8;
  for (int pass = 0; pass < kPasses; ++pass) {
    fit();
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> widths;
    for (const SkinSamples::Edge& edge : samples_.edges)
      if (const auto [a, b] = std::minmax(labels_.parts[edge.a], labels_.parts[edge.b]); a != b)
        widths[{a, b}] += edge.width;
    std::vector<Pair> pairs;
    for (const auto& [pair, width] : widths) pairs.push_back({pair.first, pair.second, width, 0});
    std::vector<double> costs(parts_.size());
    parallelRanges(parts_.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) costs[p] = costOfAll(*parts_[p].motion, parts_[p].members);
    });
    parallelRanges(pairs.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Pair& pair = pairs[k];
        std::vector<std::uint32_t> both = parts_[pair.a].members;
        both.insert(both.end(), parts_[pair.b].members.begin(), parts_[pair.b].members.end());
        const double joined = costOfAll(PartMotion(samples_, moments_, both, labels_.joints[pair.a]), both);
        pair.gain = costs[pair.a] + costs[pair.b] + kSeamPrice * pair.width - joined;
      }
    });
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& x, const Pair& y) { return x.gain > y.gain; });
    // Each part once a pass: then its neighbours have changed.
    std::vector<bool> changed(parts_.size(), false);
    bool any = false;
    for (const Pair& pair : pairs) {
      if (!(pair.gain > 0)) break;
      if (changed[pair.a] || changed[pair.b]) continue;
      changed[pair.a] = changed[pair.b] = any = true;
      for (const std::uint32_t i : parts_[pair.b].members) labels_.parts[i] = pair.a;
    }
    if (!any) break;
    removeEmpty();
  }
}

}  // namespace kelp::bake

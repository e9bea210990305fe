// SPDX-License-Identifier: MIT
// Sorting what belongs to vertices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kelp/common/parallel.h"

namespace kelp::bake {

// Returns the items of `make`, sorted by their vertex, then by `less`. make(take) calls take(vertex, item)
// for each item; vertices are below `vertices`. Each thread has a share of the vertices, and looks at all
// items twice for it: so more than a few threads gain nothing. In linear time where each vertex has few
// items: a comparing sort of all edges of a scan takes several times as long. Fewer than 2^32 items. threads:
// 0 is one for each core.
template <class Item, class Make, class Less>
std::vector<Item> sortedByVertex(std::size_t vertices, int threads, const Make& make, const Less& less) {
  constexpr std::size_t kFew = 1 << 16;  // vertices of a share, at least
  constexpr int kMostShares = 8;
  const std::size_t shares = std::clamp<std::size_t>(
      vertices / kFew, 1, static_cast<std::size_t>(std::clamp(threadCount(threads), 1, kMostShares)));
  const std::size_t share = (vertices + shares - 1) / shares;
  std::vector<std::uint32_t> end(vertices + 1, 0);  // of each vertex's items; at first where they begin
  const auto forEachShare = [&](const auto& body) {
    parallelRanges(shares, 1, threads, [&](std::size_t its, std::size_t) {
      body(its * share, std::min(vertices, (its + 1) * share));
    });
  };
  forEachShare([&](std::size_t first, std::size_t last) {
    make([&](std::uint32_t vertex, const Item&) {
      if (vertex >= first && vertex < last) ++end[vertex + 1];
    });
  });
  for (std::size_t i = 1; i <= vertices; ++i) end[i] += end[i - 1];
  std::vector<Item> items(end[vertices]);
  forEachShare([&](std::size_t first, std::size_t last) {
    std::size_t begin = end[first];
    std::vector<std::uint32_t> next(end.begin() + static_cast<std::ptrdiff_t>(first),
                                    end.begin() + static_cast<std::ptrdiff_t>(last));
    make([&](std::uint32_t vertex, const Item& item) {
      if (vertex >= first && vertex < last) items[next[vertex - first]++] = item;
    });
    for (const std::uint32_t its : next) {
      std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin),
                items.begin() + static_cast<std::ptrdiff_t>(its), less);
      begin = its;
    }
  });
  return items;
}

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Sorting what belongs to vertices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kelp::bake {

// What `make` makes, sorted by its vertex, then by `less`. make(take) calls take(vertex, item) for each item,
// and is called twice; vertices are below `vertices`. In linear time where each vertex has few items: a
// comparing sort of all edges of a scan takes several times as long. Fewer than 2^32 items.
template <class Item, class Make, class Less>
std::vector<Item> sortedByVertex(std::size_t vertices, const Make& make, const Less& less) {
  std::vector<std::uint32_t> end(vertices + 1, 0);  // of each vertex's items; at first where they begin
  make([&](std::uint32_t vertex, const Item&) { ++end[vertex + 1]; });
  for (std::size_t i = 1; i <= vertices; ++i) end[i] += end[i - 1];
  std::vector<Item> items(end[vertices]);
  make([&](std::uint32_t vertex, const Item& item) { items[end[vertex]++] = item; });
  for (std::size_t vertex = 0, begin = 0; vertex < vertices; begin = end[vertex++])
    std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin),
              items.begin() + static_cast<std::ptrdiff_t>(end[vertex]), less);
  return items;
}

}  // namespace kelp::bake

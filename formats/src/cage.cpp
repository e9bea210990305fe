// SPDX-License-Identifier: MIT
#include "kelp/formats/cage.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "cage_maker.h"

namespace kelp {

Result<Cage> makeCage(const CageSource& source, const glm::ivec3& size, int levels, int cell, int cage,
                      const Cage* finer, std::uint64_t max_bytes, CageMemory& memory) {
  constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for a cage"};
  const Result<Cage> shape = cageShape(size, levels, cell, cage);
  if (!shape) return shape;
  CageMaker maker(source, *shape, memory.words.allocator());
  if (const Result<void> r = maker.count(); !r) return r.error();
  // Nodes and faces come later; a cell has at most 8 nodes and 12 faces.
  if (maker.wordsFor(0) * sizeof(std::uint32_t) > max_bytes)
    return Error{ErrorCode::kLimit, "a cage has more cells than the limits allow"};
  Buffer<std::uint32_t> cells(memory.words.allocator());
  if (!cells.reset(std::uint64_t{kCageCellWords} * maker.cells())) return kNoMemory;
  if (const Result<void> r = maker.connect(cells.span()); !r) return r.error();
  if (!memory.words.reset(maker.words()) || !memory.places.reset(maker.nodes()) ||
      !memory.follows.reset(finer ? maker.nodes() : 0))
    return kNoMemory;
  std::copy(cells.begin(), cells.end(), memory.words.begin() + kCageHeader);
  return maker.write(memory.words.span(), memory.places.span(), memory.follows.span(), finer);
}

CageFollow cageFollows(const Cage& cage, std::uint32_t node, const Cage& finer) {
  const std::uint32_t at = cage.follows[node];
  const glm::vec3 f =
      glm::vec3(cage.rest(node) - finer.side * finer.place(at)) / static_cast<float>(finer.side);
  int order[3] = {0, 1, 2};
  if (f[order[1]] > f[order[0]]) std::swap(order[0], order[1]);
  if (f[order[2]] > f[order[1]]) std::swap(order[1], order[2]);
  if (f[order[1]] > f[order[0]]) std::swap(order[0], order[1]);
  const int a = 1 << order[0], b = a | 1 << order[1];
  return {{finer.node(at, 0), finer.node(at, a), finer.node(at, b), finer.node(at, 7)},
          {1 - f[order[0]], f[order[0]] - f[order[1]], f[order[1]] - f[order[2]], f[order[2]]}};
}

}  // namespace kelp

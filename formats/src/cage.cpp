// SPDX-License-Identifier: MIT
#include "kelp/formats/cage.h"

#include <algorithm>
#include <cstddef>

#include <glm/common.hpp>

#include "cage_maker.h"

namespace kelp {

Result<Cage> makeCage(const CageSource& source, const glm::ivec3& size, int levels, int cell, int level,
                      const Cage* finer, std::uint64_t max_bytes, CageMemory& memory) {
  constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for a cage"};
  const Result<Cage> shape = cageShape(size, levels, cell, level);
  if (!shape) return shape;
  CageMaker maker(source, *shape, memory.words.allocator());
  if (const Result<void> r = maker.count(); !r) return r.error();
  // Nodes and faces are counted later.
  const auto fits = [&](std::uint64_t words) {
    return words * sizeof(std::uint32_t) + maker.transientBytes() <= max_bytes;
  };
  constexpr Error kTooLarge{ErrorCode::kLimit, "a cage takes more memory than the limits allow"};
  if (!fits(maker.wordsFor(0) + maker.leafSlots())) return kTooLarge;
  Buffer<std::uint32_t> cells(memory.words.allocator());
  if (!cells.reset(std::uint64_t{kCageCellWords} * maker.cells())) return kNoMemory;
  if (const Result<void> r = maker.connect(cells.span()); !r) return r.error();
  const std::uint64_t followers = finer ? maker.nodes() : 0;
  if (!fits(cells.size() + maker.words() + maker.nodes() + followers + maker.leafSlots())) return kTooLarge;
  if (!memory.words.reset(maker.words()) || !memory.places.reset(maker.nodes()) ||
      !memory.follows.reset(followers) || !memory.leaves.reset(maker.leafSlots()))
    return kNoMemory;
  std::copy(cells.begin(), cells.end(), memory.words.begin() + kCageHeader);
  return maker.write(memory.words.span(), memory.places.span(), memory.follows.span(), finer,
                     memory.leaves.span());
}

CageFollow cageFollows(const Cage& cage, std::uint32_t node, const Cage& finer) {
  const std::uint32_t word = cage.follows[node], at = word & ~kFollowsAll;
  if (!(word & kFollowsAll)) return {1, {at}, {1}};
  // In sides of the finer cell.
  const glm::ivec3 f = cage.rest(node) / finer.side - finer.place(at);
  CageFollow follow;
  follow.count = 8;
  for (int i = 0; i < 8; ++i) follow.nodes[i] = finer.node(at, i);
  const glm::vec3 towards = 0.25f * (glm::vec3(f) - 0.5f);
  for (int i = 0; i < 8; ++i)
    follow.weights[i] = 0.125f + (i & 1 ? towards.x : -towards.x) + (i & 2 ? towards.y : -towards.y) +
                        (i & 4 ? towards.z : -towards.z);
  return follow;
}

std::uint32_t cageInfluencer(const Cage& cage, std::uint32_t node, const Cage& finer) {
  const std::uint32_t word = cage.follows[node], at = word & ~kFollowsAll;
  if (!(word & kFollowsAll)) return at;
  const glm::ivec3 f = glm::clamp(cage.rest(node) / finer.side - finer.place(at), 0, 1);
  return finer.node(at, f.x | f.y << 1 | f.z << 2);
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
// The CAGE chunk.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "layout.h"
#include "metadata_writer.h"
#include "record_writer.h"

namespace kelp {
namespace {

constexpr int kMostSteps = 1 << 20;  // floats hold them, and integers what coarser cages make of them

// The nodes of a cage that a morph target moves.
struct MovedNodes {
  std::vector<std::uint32_t> nodes;
  std::vector<glm::ivec3> offsets;  // in its steps
};

// About all cages of a pack, part by part.
struct CageNumbers {
  std::vector<std::uint32_t> counts;  // the five numbers of each
  std::vector<MovedNodes> moved;      // of each, a list for each morph target of its part
};

// The offsets of a coarser cage's nodes, of all of them as those of the finer one.
std::vector<glm::vec3> coarserOffsets(const Cage& cage, const Cage& finer,
                                      const std::vector<glm::vec3>& offsets) {
  std::vector<glm::vec3> own(cage.nodes(), glm::vec3(0));
  for (std::uint32_t node = 0; node < cage.nodes(); ++node) {
    const CageFollow follow = cageFollows(cage, node, finer);
    for (int k = 0; k < follow.count; ++k) own[node] += follow.weights[k] * offsets[follow.nodes[k]];
  }
  return own;
}

MovedNodes movedBy(const std::vector<glm::vec3>& offsets) {
  MovedNodes moved;
  for (std::size_t node = 0; node < offsets.size(); ++node) {
    const glm::ivec3 offset(glm::round(offsets[node]));
    if (offset == glm::ivec3(0)) continue;
    moved.nodes.push_back(static_cast<std::uint32_t>(node));
    moved.offsets.push_back(offset);
  }
  return moved;
}

// The offsets that a morph target has for each node of the finest cage.
Result<std::vector<glm::vec3>> offsetsOf(const RawMorph& morph, std::uint32_t nodes) {
  if (morph.nodes.size() != morph.offsets.size())
    return misuse("a morph target does not have an offset for each node that it moves");
  std::vector<glm::vec3> offsets(nodes, glm::vec3(0));
  for (std::size_t i = 0; i < morph.nodes.size(); ++i) {
    if (morph.nodes[i] >= nodes || (i > 0 && morph.nodes[i] <= morph.nodes[i - 1]))
      return misuse("the nodes that a morph target moves do not ascend, or do not exist");
    if (glm::any(glm::greaterThan(glm::abs(morph.offsets[i]), glm::ivec3(kMostSteps))))
      return misuse("an offset of a morph target has more than 2^20 steps");
    offsets[morph.nodes[i]] = morph.offsets[i];
  }
  return offsets;
}

Result<void> countCages(const RawPart& part, CageNumbers& numbers) {
  if (!part.morphs.empty() && part.influences.empty())
    return misuse("a part whose nodes follow no parts has morph targets");
  CageMemory even{Allocator()}, odd{Allocator()};
  Cage cages[2];
  std::vector<std::vector<glm::vec3>> offsets(part.morphs.size());
  for (std::size_t i = 0; i < part.cages.size(); ++i) {
    const RawCage& raw = part.cages[i];
    const Cage* const finer = i > 0 ? &cages[(i - 1) & 1] : nullptr;
    const Result<Cage> cage =
        makeCage(raw.source(), part.size, static_cast<int>(part.levels.size()), part.cell,
                 static_cast<int>(i), finer, std::numeric_limits<std::uint64_t>::max(), i & 1 ? odd : even);
    if (!cage) return cage.error().code == ErrorCode::kOutOfMemory ? kNoMemory : misuse(cage.error().detail);
    cages[i & 1] = *cage;
    if (i == 0 && !part.influences.empty() && part.influences.size() != cage->nodes())
      return misuse("a part does not have influences for each node of its finest cage");
    for (const std::size_t count : {std::size_t{cage->nodes()}, std::size_t{cage->faces()},
                                    raw.split_points.size(), raw.splits.size(), raw.follows.size()})
      numbers.counts.push_back(static_cast<std::uint32_t>(count));
    for (std::size_t m = 0; m < offsets.size(); ++m) {
      if (finer) {
        offsets[m] = coarserOffsets(*cage, *finer, offsets[m]);
      } else {
        Result<std::vector<glm::vec3>> own = offsetsOf(part.morphs[m], cage->nodes());
        if (!own) return own.error();
        offsets[m] = *std::move(own);
      }
      numbers.moved.push_back(movedBy(offsets[m]));
    }
  }
  return {};
}

std::size_t influenceCount(const Influences& node) {
  return static_cast<std::size_t>(std::find(node.weights, node.weights + 4, 0) - node.weights);
}

// Adds those of a part to `count`. The rest of the rules is checked when the table is read.
Result<void> countInfluences(const RawPart& part, std::size_t& count) {
  for (const Influences& node : part.influences) {
    const unsigned sum = std::accumulate(node.weights, node.weights + influenceCount(node), 0u);
    if (sum != 255)
      return misuse("the weights of a cage's node do not sum to 255, or a weight of 0 is not the last");
    count += influenceCount(node);
  }
  return {};
}

// Puts the influences of all parts.
void putInfluences(const RawPack& pack, std::size_t count, RecordWriter& to) {
  const auto forEach = [&](const auto& visit) {
    for (const RawPart& part : pack.parts)
      for (const Influences& node : part.influences) visit(node, influenceCount(node));
  };
  forEach([&](const Influences&, std::size_t own) { to.put(static_cast<std::uint8_t>(own)); });
  to.planes(count, [&](const auto& put) {
    forEach([&](const Influences& node, std::size_t own) {
      for (std::size_t i = 0; i < own; ++i) put(node.parts[i]);
    });
  });
  forEach([&](const Influences& node, std::size_t own) {
    for (std::size_t i = 0; i + 1 < own; ++i) to.put(node.weights[i]);
  });
}

// Signed numbers small in size become small numbers.
std::uint32_t folded(std::int32_t number) {
  const auto bits = static_cast<std::uint32_t>(number);
  return number < 0 ? ~(bits << 1) : bits << 1;
}

// Ascending numbers.
template <class Put>
void putAscending(std::span<const std::uint32_t> numbers, const Put& put) {
  std::uint32_t least = 0;
  for (const std::uint32_t number : numbers) {
    put(number - least);
    least = number + 1;
  }
}

// Of morph targets and sections.
std::uint64_t moverBytes(const RawPack& pack, const CageNumbers& numbers) {
  std::uint64_t count = numbers.moved.size();
  for (const RawPart& part : pack.parts) count += part.sections >= 0 ? 1 : 0;
  for (const RawPart& part : pack.parts)
    count += (part.morphs.empty() ? 0 : 1) + layout::kMorphCounts * part.morphs.size();
  for (const MovedNodes& moved : numbers.moved) count += 4 * moved.nodes.size();
  return count * sizeof(std::uint32_t);
}

// Puts the morph targets of all parts.
void putMorphs(const RawPack& pack, const CageNumbers& numbers, RecordWriter& to) {
  std::size_t parts = 0, morphs = 0, moved = 0;
  for (const RawPart& part : pack.parts) {
    parts += part.morphs.empty() ? 0 : 1;
    morphs += part.morphs.size();
  }
  for (const MovedNodes& list : numbers.moved) moved += list.nodes.size();
  to.planes(parts, [&](const auto& put) {
    for (const RawPart& part : pack.parts)
      if (!part.morphs.empty()) put(static_cast<std::uint32_t>(part.morphs.size()));
  });
  to.planes(layout::kMorphCounts * morphs, [&](const auto& put) {
    for (const RawPart& part : pack.parts) {
      for (const RawMorph& morph : part.morphs) {
        put(morph.part);
        put(glm::floatBitsToUint(morph.step));
      }
    }
  });
  to.planes(numbers.moved.size(), [&](const auto& put) {
    for (const MovedNodes& list : numbers.moved) put(static_cast<std::uint32_t>(list.nodes.size()));
  });
  to.planes(moved, [&](const auto& put) {
    for (const MovedNodes& list : numbers.moved) putAscending(list.nodes, put);
  });
  to.planes(3 * moved, [&](const auto& put) {
    for (const MovedNodes& list : numbers.moved)
      for (const glm::ivec3& offset : list.offsets)
        for (int axis = 0; axis < 3; ++axis) put(folded(offset[axis]));
  });
}

}  // namespace

Result<void> buildCages(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t cages = 0, points = 0, follows = 0, influences = 0;
  CageNumbers numbers;
  std::uint64_t bytes = layout::kCageTable + pack.parts.size();
  for (const RawPart& part : pack.parts) {
    if (part.cages.empty() && !part.influences.empty()) return misuse("a part without a cage has influences");
    if (part.cages.empty() && !part.morphs.empty()) return misuse("a part without a cage has morph targets");
    if (part.sections >= 0 && (part.cages.empty() || !part.influences.empty()))
      return misuse("a part has sections, but no cage that its own spline moves");
    if (part.cages.empty()) continue;
    if (const Result<void> r = countInfluences(part, influences); !r) return r;
    if (part.cell != 2 && part.cell != 4 && part.cell != 8 && part.cell != 16)
      return misuse("the cells of a part's cage do not have a side of 2, 4, 8 or 16");
    if (part.cages.size() != part.levels.size())
      return misuse("a part does not have one cage for each of its levels");
    cages += part.cages.size();
    if (const Result<void> r = countCages(part, numbers); !r) return r;
    for (const RawCage& cage : part.cages) {
      points += cage.split_points.size();
      follows += cage.follows.size();
      bytes += cage.blocks.size() + cage.masks.size() + cage.splits.size();
    }
  }
  bytes += layout::kCageRecord * cages + 5 * influences + sizeof(std::uint32_t) * (points + follows) +
           moverBytes(pack, numbers);
  if (bytes > std::numeric_limits<std::uint32_t>::max()) return misuse("the cages take more than 4 GiB");
  if (!out.reset(bytes)) return kNoMemory;
  RecordWriter to(out);
  to.count(pack.parts.size());
  for (const RawPart& part : pack.parts)
    to.put(static_cast<std::uint8_t>(part.cages.empty()
                                         ? 0
                                         : std::countr_zero(static_cast<unsigned>(part.cell)) |
                                               (part.influences.empty() ? 0 : layout::kInfluenced) |
                                               (part.morphs.empty() ? 0 : layout::kMorphed) |
                                               (part.sections < 0 ? 0 : layout::kSectioned)));
  to.planes(numbers.counts.size(), [&](const auto& put) {
    for (const std::uint32_t count : numbers.counts) put(count);
  });
  const auto forEach = [&](const auto& visit) {
    for (const RawPart& part : pack.parts)
      for (const RawCage& cage : part.cages) visit(cage);
  };
  forEach([&](const RawCage& cage) { to.array(cage.blocks); });
  forEach([&](const RawCage& cage) { to.array(cage.masks); });
  to.planes(points, [&](const auto& put) {
    forEach([&](const RawCage& cage) { putAscending(cage.split_points, put); });
  });
  forEach([&](const RawCage& cage) { to.array(cage.splits); });
  to.planes(follows, [&](const auto& put) {
    forEach([&](const RawCage& cage) {
      std::uint32_t last = 0;
      for (const std::uint32_t cell : cage.follows) {
        put(folded(static_cast<std::int32_t>(cell - last)));
        last = cell;
      }
    });
  });
  putInfluences(pack, influences, to);
  putMorphs(pack, numbers, to);
  const auto sectioned = std::count_if(pack.parts.begin(), pack.parts.end(),
                                       [](const RawPart& part) { return part.sections >= 0; });
  to.planes(static_cast<std::size_t>(sectioned), [&](const auto& put) {
    for (const RawPart& part : pack.parts)
      if (part.sections >= 0) put(static_cast<std::uint32_t>(part.sections));
  });
  return {};
}

}  // namespace kelp

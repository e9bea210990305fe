// SPDX-License-Identifier: MIT
// The CAGE chunk.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>

#include "array_reader.h"
#include "cage_maker.h"
#include "metadata.h"
#include "record_reader.h"

namespace kelp {
namespace {

constexpr Error kTooShort{ErrorCode::kCorrupt, "the cage table's size does not match its counts", 0};

// A cage, as far as the table says before it is made.
struct CagePlan {
  Cage shape;
  CageSource source;
  std::uint32_t nodes = 0, faces = 0, split_points = 0, splits = 0, followed = 0;
  std::size_t at = 0;  // its counts in the chunk, their lowest bytes
  std::uint64_t words = 0, leaf_slots = 0;
  std::size_t part = 0;
  bool influenced = false;  // its nodes follow parts
  bool morphed = false;     // morph targets move them, too
  std::span<Influences> influences;
  std::span<const Morph> morphs;

  bool isFinest() const { return shape.level == 0; }
  std::uint32_t followers() const { return isFinest() ? 0 : nodes; }
};

struct CageTable {
  std::span<const std::byte> chunk;
  Metadata& out;
  Buffer<CagePlan> plans{out.allocator};
  Buffer<std::uint32_t> numbers{out.allocator};  // the split points of all cages, then the followed cells
  ArrayReader arrays{chunk, 0};

  Error inRecord(const Error& error, const CagePlan& plan) const {
    return {error.code, error.detail, plan.at};
  }
  std::uint8_t kindOf(std::size_t part) const {
    return layout::load<std::uint8_t>(chunk, layout::kCageTable + part);
  }

  Result<void> countCages();
  Result<void> readRecords();
  Result<void> measure();
  // The next `count` numbers of the chunk.
  Result<void> readNumbers(std::uint64_t count, Buffer<std::uint32_t>& into);
  Result<void> readInfluences();
  Result<void> readMorphs();
  Result<void> fillMorph(const CagePlan& plan, std::span<const std::uint32_t> nodes, float step,
                         std::span<MovedNode> moved) const;
  Result<void> readSections();
  Result<void> make();
};

Result<void> CageTable::countCages() {
  const std::size_t parts = out.parts.size();
  if (chunk.size() < layout::kCageTable + parts || layout::load<std::uint32_t>(chunk, 0) != parts)
    return corrupt("the cage table has a different number of parts", 0);
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t at = layout::kCageTable + i;
    const unsigned kind = kindOf(i), log = kind & 15u;
    if (kind == 0) continue;
    if (log < 1 || log > 4)
      return corrupt("the cells of a part's cage do not have a side of 2, 4, 8 or 16", at);
    const unsigned flags = kind - log;
    if (flags != 0 && flags != layout::kInfluenced && flags != layout::kSectioned &&
        flags != (layout::kInfluenced | layout::kMorphed))
      return corrupt("a cage is moved in a way that there is not", at);
    if (out.parts[i].kind != PartKind::kSolid) return corrupt("a part that is not solid has a cage", at);
    count += static_cast<std::uint64_t>(out.parts[i].levels);
  }
  if (count == 0) return corrupt("there is a cage table, but no part has a cage", 0);
  if ((chunk.size() - layout::kCageTable - parts) / layout::kCageRecord < count)
    return corrupt("the cage table is too short", 0);
  if (!out.takeRoom(count, sizeof(Cage) + sizeof(CagePlan) + layout::kCageRecord)) return tooLarge();
  if (!out.cages.reset(count) || !plans.reset(count)) return outOfMemory("no memory for the cages");
  return {};
}

Result<void> CageTable::readRecords() {
  arrays = ArrayReader(chunk, layout::kCageTable + out.parts.size());
  Buffer<std::uint32_t> counts(out.allocator);
  if (!counts.reset(layout::kCageCounts * plans.size())) return outOfMemory("no memory for the cages");
  arrays.numbers(counts.span());
  std::size_t next = 0;
  for (std::size_t i = 0; i < out.parts.size(); ++i) {
    Part& part = out.parts[i];
    const unsigned kind = kindOf(i);
    const int cell = 1 << (kind & 15u), count = kind ? part.levels : 0;
    part.cages = out.cages.span().subspan(next, static_cast<std::size_t>(count));
    for (int level = 0; level < count; ++level) {
      const std::uint32_t* const its = &counts[layout::kCageCounts * next];
      CagePlan& plan = plans[next];
      plan.at = layout::kCageTable + out.parts.size() + layout::kCageCounts * next++;
      const Result<Cage> shape = cageShape(part.size, part.levels, cell, level);
      if (!shape) return inRecord(shape.error(), plan);
      plan.shape = *shape;
      plan.nodes = its[0];
      plan.faces = its[1];
      plan.split_points = its[2];
      plan.splits = its[3];
      plan.followed = its[4];
      plan.part = i;
      plan.influenced = kind & layout::kInfluenced;
      plan.morphed = kind & layout::kMorphed;
    }
  }
  return {};
}

// Finds all arrays, and takes room for the cages.
Result<void> CageTable::measure() {
  for (CagePlan& plan : plans) {
    const glm::ivec3& grid = plan.shape.grid;
    const std::size_t blocks = static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) *
                               static_cast<std::size_t>(grid.z);
    if (!arrays.has(blocks)) return kTooShort;
    plan.source.blocks = arrays.bytes(blocks);
  }
  std::uint64_t words = 0, transient = 0, points = 0, followed = 0, influenced = 0;
  for (CagePlan& plan : plans) {
    CageMaker maker(plan.source, plan.shape, out.allocator);
    if (const Result<void> r = maker.count(); !r) return inRecord(r.error(), plan);
    const std::uint64_t masks = std::uint64_t{maker.pieces()} * cageMaskBytes(plan.shape);
    if (plan.nodes > 8 * std::uint64_t{maker.cells()} || plan.faces > 12 * std::uint64_t{maker.cells()})
      return corrupt("a cage has more nodes or faces than its cells have", plan.at);
    if (!arrays.has(masks)) return kTooShort;
    plan.source.masks = arrays.bytes(static_cast<std::size_t>(masks));
    plan.words = maker.wordsFor(plan.faces);
    plan.leaf_slots = maker.leafSlots();
    words += plan.words + plan.nodes + plan.followers() + plan.leaf_slots;
    if (plan.influenced) influenced += plan.nodes;
    transient = std::max(transient, maker.transientBytes());
    points += plan.split_points;
    followed += plan.followed;
  }
  const std::uint64_t numbers_bytes = (points + followed) * sizeof(std::uint32_t);
  if (!arrays.has(numbers_bytes)) return kTooShort;
  if (!out.takeRoom(words, sizeof(std::uint32_t)) || !out.takeRoom(influenced, sizeof(Influences)) ||
      transient + numbers_bytes > out.room)
    return tooLarge();
  if (!out.cage_words.reset(words) || !numbers.reset(points + followed) || !out.influences.reset(influenced))
    return outOfMemory("no memory for the cages");
  std::span<std::uint32_t> cells = numbers.span(), split_points = take(cells, points);
  arrays.numbers(split_points);
  for (CagePlan& plan : plans) {
    if (!arrays.has(plan.splits)) return kTooShort;
    plan.source.splits = arrays.bytes(plan.splits);
  }
  if (!arrays.has(cells.size_bytes())) return kTooShort;
  arrays.numbers(cells);
  std::span<Influences> influences = out.influences.span();
  for (CagePlan& plan : plans) {
    const std::span<std::uint32_t> points = take(split_points, plan.split_points),
                                   followed_cells = take(cells, plan.followed);
    sumAscending(points);
    std::uint32_t last = 0;
    for (std::uint32_t& cell : followed_cells) cell = last += static_cast<std::uint32_t>(unfolded(cell));
    plan.source.split_points = points;
    plan.source.follows = followed_cells;
    if (plan.influenced) plan.influences = take(influences, plan.nodes);
  }
  return {};
}

Result<void> CageTable::readNumbers(std::uint64_t count, Buffer<std::uint32_t>& into) {
  if (!arrays.has(count * sizeof(std::uint32_t))) return kTooShort;
  if (count * sizeof(std::uint32_t) > out.room) return tooLarge();
  if (!into.reset(count)) return outOfMemory("no memory for the cages");
  arrays.numbers(into.span());
  return {};
}

// Of finest cages; those of coarser ones follow from them, when these are made.
Result<void> CageTable::readInfluences() {
  std::uint64_t nodes = 0, total = 0;
  for (const CagePlan& plan : plans)
    if (plan.isFinest()) nodes += plan.influences.size();
  if (!arrays.has(nodes)) return kTooShort;
  const std::span<const std::uint8_t> counts = arrays.bytes(static_cast<std::size_t>(nodes));
  for (const std::uint8_t count : counts) {
    if (count < 1 || count > 4) return corrupt("a node of a cage follows no part, or more than four", 0);
    total += count;
  }
  Buffer<std::uint32_t> parts(out.allocator);
  if (const Result<void> r = readNumbers(total, parts); !r) return r;
  if (!arrays.has(total - nodes)) return kTooShort;
  const std::span<const std::uint8_t> weights = arrays.bytes(static_cast<std::size_t>(total - nodes));
  std::size_t node = 0, part = 0, weight = 0;
  for (const CagePlan& plan : plans) {
    if (!plan.isFinest()) continue;
    for (Influences& its : plan.influences) {
      const std::size_t last = counts[node++] - std::size_t{1};
      std::uint32_t left = 255;
      for (std::size_t i = 0; i <= last; ++i) {
        const std::uint32_t of = parts[part++], share = i < last ? weights[weight++] : left;
        if (of >= std::min<std::size_t>(out.parts.size(), 65536) || of == plan.part)
          return corrupt("a node of a cage follows its own part, or one that does not exist", plan.at);
        if (i > 0 && of <= its.parts[i - 1])
          return corrupt("the parts that a node of a cage follows do not ascend", plan.at);
        if (share == 0 || share > left)
          return corrupt("the weights of a cage's node do not sum to 255", plan.at);
        its.parts[i] = static_cast<std::uint16_t>(of);
        its.weights[i] = static_cast<std::uint8_t>(share);
        left -= share;
      }
    }
  }
  return {};
}

// The targets that move a part are the same for all its cages.
Result<void> CageTable::readMorphs() {
  Buffer<std::uint32_t> morphs(out.allocator), records(out.allocator), counts(out.allocator),
      nodes(out.allocator), offsets(out.allocator);
  const auto isFirst = [](const CagePlan& plan) { return plan.morphed && plan.isFinest(); };
  const auto parts = std::count_if(plans.begin(), plans.end(), isFirst);
  if (const Result<void> r = readNumbers(static_cast<std::uint64_t>(parts), morphs); !r) return r;
  std::uint64_t targets = 0, lists = 0, moved = 0;
  for (std::size_t next = 0; const CagePlan& plan : plans) {
    if (!plan.morphed) continue;
    if (plan.isFinest() && morphs[next] == 0)
      return corrupt("a part that morph targets move has none", plan.at);
    if (plan.isFinest()) targets += morphs[next++];
    lists += morphs[next - 1];
  }
  if (const Result<void> r = readNumbers(layout::kMorphCounts * targets, records); !r) return r;
  if (const Result<void> r = readNumbers(lists, counts); !r) return r;
  for (const std::uint32_t count : counts) moved += count;
  if (const Result<void> r = readNumbers(moved, nodes); !r) return r;
  if (const Result<void> r = readNumbers(3 * moved, offsets); !r) return r;
  if (!out.takeRoom(lists, sizeof(Morph)) || !out.takeRoom(moved, sizeof(MovedNode))) return tooLarge();
  if (!out.morphs.reset(lists) || !out.moved_nodes.reset(moved))
    return outOfMemory("no memory for the cages");
  std::span<Morph> morphs_left = out.morphs.span();
  std::span<MovedNode> moved_left = out.moved_nodes.span();
  std::span<std::uint32_t> nodes_left = nodes.span(), its_records, records_left = records.span();
  for (std::size_t i = 0; i < moved; ++i)
    for (int axis = 0; axis < 3; ++axis)
      out.moved_nodes[i].offset[axis] =
          static_cast<float>(unfolded(offsets[3 * i + static_cast<std::size_t>(axis)]));
  std::size_t part = 0, list = 0;
  for (CagePlan& plan : plans) {
    if (!plan.morphed) continue;
    if (plan.isFinest())
      its_records = take(records_left, layout::kMorphCounts * std::uint64_t{morphs[part++]});
    const std::span<Morph> its = take(morphs_left, its_records.size() / layout::kMorphCounts);
    for (std::size_t m = 0; m < its.size(); ++m, ++list) {
      const std::uint32_t of = its_records[2 * m];
      if (of >= out.parts.size() || out.parts[of].kind != PartKind::kEmpty ||
          (m > 0 && of <= its[m - 1].part))
        return corrupt("the parts of morph targets are not empty ones, ascending", plan.at);
      const std::span<MovedNode> its_nodes = take(moved_left, counts[list]);
      const std::span<std::uint32_t> numbers = take(nodes_left, counts[list]);
      sumAscending(numbers);
      const Result<void> r =
          fillMorph(plan, numbers, glm::uintBitsToFloat(its_records[2 * m + 1]), its_nodes);
      if (!r) return r;
      its[m] = {of, its_nodes};
    }
    plan.morphs = its;
  }
  return {};
}

Result<void> CageTable::fillMorph(const CagePlan& plan, std::span<const std::uint32_t> nodes, float step,
                                  std::span<MovedNode> moved) const {
  if (!(step > 0) || !std::isfinite(step))
    return corrupt("the step of a morph target is not above 0", plan.at);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i] >= plan.nodes || (i > 0 && nodes[i] <= nodes[i - 1]))
      return corrupt("the nodes that a morph target moves do not ascend, or do not exist", plan.at);
    moved[i].node = nodes[i];
    moved[i].offset *= step;
    if (!isFinite(moved[i].offset)) return corrupt("a morph target moves a node beyond all numbers", plan.at);
  }
  return {};
}

Result<void> CageTable::readSections() {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < out.parts.size(); ++i) count += kindOf(i) & layout::kSectioned ? 1 : 0;
  Buffer<std::uint32_t> parts(out.allocator);
  if (const Result<void> r = readNumbers(count, parts); !r) return r;
  std::size_t next = 0;
  for (std::size_t i = 0; i < out.parts.size(); ++i) {
    if (!(kindOf(i) & layout::kSectioned)) continue;
    const std::uint32_t of = parts[next++];
    if (of >= out.parts.size() || out.parts[of].kind != PartKind::kEmpty)
      return corrupt("the part of a part's sections is not an empty one", layout::kCageTable + i);
    out.parts[i].sections = static_cast<int>(of);
  }
  return {};
}

Result<void> CageTable::make() {
  std::span<std::uint32_t> memory = out.cage_words.span();
  for (std::size_t i = 0; i < plans.size(); ++i) {
    CagePlan& plan = plans[i];
    const std::span<std::uint32_t> words = take(memory, plan.words), places = take(memory, plan.nodes),
                                   follows = take(memory, plan.followers()),
                                   slots = take(memory, plan.leaf_slots);
    CageMaker maker(plan.source, plan.shape, out.allocator);
    if (const Result<void> r = maker.count(); !r) return inRecord(r.error(), plan);
    const Result<void> r =
        maker.connect(words.subspan(kCageHeader, std::size_t{kCageCellWords} * maker.cells()));
    if (!r) return inRecord(r.error(), plan);
    if (maker.nodes() != plan.nodes || maker.faces() != plan.faces)
      return corrupt("a cage's number of nodes or faces does not follow from its cells", plan.at);
    const Result<Cage> cage =
        maker.write(words, places, follows, plan.isFinest() ? nullptr : &out.cages[i - 1], slots);
    if (!cage) return inRecord(cage.error(), plan);
    out.cages[i] = *cage;
    out.cages[i].influences = plan.influences;
    out.cages[i].morphs = plan.morphs;
    if (plan.isFinest()) continue;
    for (std::uint32_t node = 0; node < plan.influences.size(); ++node)
      plan.influences[node] = out.cages[i - 1].influences[cageInfluencer(*cage, node, out.cages[i - 1])];
  }
  return {};
}

}  // namespace

Result<void> parseCages(std::span<const std::byte> chunk, Metadata& out) {
  CageTable table{chunk, out};
  if (const Result<void> r = table.countCages(); !r) return r;
  if (const Result<void> r = table.readRecords(); !r) return r;
  if (const Result<void> r = table.measure(); !r) return r;
  if (const Result<void> r = table.readInfluences(); !r) return r;
  if (const Result<void> r = table.readMorphs(); !r) return r;
  if (const Result<void> r = table.readSections(); !r) return r;
  if (!table.arrays.done()) return kTooShort;
  return table.make();
}

}  // namespace kelp

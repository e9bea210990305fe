// SPDX-License-Identifier: MIT
// The CAGE chunk.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "cage_maker.h"
#include "metadata.h"
#include "record_reader.h"

namespace kelp {
namespace {

// Takes one array after the other.
class ArrayReader {
 public:
  ArrayReader(std::span<const std::byte> bytes, std::uint64_t at) : bytes_(bytes), at_(at) {}

  bool has(std::uint64_t bytes) const { return at_ <= bytes_.size() && bytes <= bytes_.size() - at_; }
  std::span<const std::uint8_t> bytes(std::size_t count) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes_.data() + at_);
    at_ += count;
    return {first, count};
  }
  // In planes.
  void numbers(std::span<std::uint32_t> out) {
    for (std::uint32_t& number : out) number = 0;
    for (unsigned plane = 0; plane < 4; ++plane)
      for (std::uint32_t& number : out)
        number |= std::to_integer<std::uint32_t>(bytes_[at_++]) << (8 * plane);
  }
  bool done() const { return at_ == bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t at_;
};

// A cage, as far as the table says before it is made.
struct CagePlan {
  Cage shape;
  CageSource source;
  std::uint32_t nodes = 0, faces = 0, split_points = 0, splits = 0, followed = 0;
  std::size_t at = 0;  // its counts in the chunk, their lowest bytes
  std::uint64_t words = 0, leaf_slots = 0;
  std::size_t part = 0;
  bool influenced = false;  // its nodes follow parts
  std::span<Influences> influences;

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
  Result<void> readInfluences();
  Result<void> make();
};

Result<void> CageTable::countCages() {
  const std::size_t parts = out.parts.size();
  if (chunk.size() < layout::kCageTable + parts || layout::load<std::uint32_t>(chunk, 0) != parts)
    return corrupt("the cage table has a different number of parts", 0);
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t at = layout::kCageTable + i;
    const unsigned kind = kindOf(i), log = kind & ~unsigned{layout::kInfluenced};
    if (kind == 0) continue;
    if (log < 1 || log > 4)
      return corrupt("the cells of a part's cage do not have a side of 2, 4, 8 or 16", at);
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
    const int cell = 1 << (kind & ~unsigned{layout::kInfluenced}), count = kind ? part.levels : 0;
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
    }
  }
  return {};
}

// Takes the first `count` of what is left.
template <class T>
std::span<T> take(std::span<T>& from, std::uint64_t count) {
  const std::span<T> taken = from.first(static_cast<std::size_t>(count));
  from = from.subspan(taken.size());
  return taken;
}

// Of one cage: from differences.
void sumPoints(std::span<std::uint32_t> points) {
  std::uint32_t least = 0;
  for (std::uint32_t& point : points) {
    point += least;
    least = point + 1;
  }
}
void sumCells(std::span<std::uint32_t> cells) {
  std::uint32_t last = 0;
  for (std::uint32_t& cell : cells) cell = last += cell & 1 ? ~(cell >> 1) : cell >> 1;
}

// Finds all arrays, and takes room for the cages.
Result<void> CageTable::measure() {
  const Error too_short = corrupt("the cage table's size does not match its counts", 0);
  for (CagePlan& plan : plans) {
    const glm::ivec3& grid = plan.shape.grid;
    const std::size_t blocks = static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) *
                               static_cast<std::size_t>(grid.z);
    if (!arrays.has(blocks)) return too_short;
    plan.source.blocks = arrays.bytes(blocks);
  }
  std::uint64_t words = 0, transient = 0, points = 0, followed = 0, influenced = 0;
  for (CagePlan& plan : plans) {
    CageMaker maker(plan.source, plan.shape, out.allocator);
    if (const Result<void> r = maker.count(); !r) return inRecord(r.error(), plan);
    const std::uint64_t masks = std::uint64_t{maker.pieces()} * cageMaskBytes(plan.shape);
    if (plan.nodes > 8 * std::uint64_t{maker.cells()} || plan.faces > 12 * std::uint64_t{maker.cells()})
      return corrupt("a cage has more nodes or faces than its cells have", plan.at);
    if (!arrays.has(masks)) return too_short;
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
  if (!arrays.has(numbers_bytes)) return too_short;
  if (!out.takeRoom(words, sizeof(std::uint32_t)) || !out.takeRoom(influenced, sizeof(Influences)) ||
      transient + numbers_bytes > out.room)
    return tooLarge();
  if (!out.cage_words.reset(words) || !numbers.reset(points + followed) || !out.influences.reset(influenced))
    return outOfMemory("no memory for the cages");
  std::span<std::uint32_t> cells = numbers.span(), split_points = take(cells, points);
  arrays.numbers(split_points);
  for (CagePlan& plan : plans) {
    if (!arrays.has(plan.splits)) return too_short;
    plan.source.splits = arrays.bytes(plan.splits);
  }
  if (!arrays.has(cells.size_bytes())) return too_short;
  arrays.numbers(cells);
  std::span<Influences> influences = out.influences.span();
  for (CagePlan& plan : plans) {
    const std::span<std::uint32_t> points = take(split_points, plan.split_points),
                                   followed_cells = take(cells, plan.followed);
    sumPoints(points);
    sumCells(followed_cells);
    plan.source.split_points = points;
    plan.source.follows = followed_cells;
    if (plan.influenced) plan.influences = take(influences, plan.nodes);
  }
  return readInfluences();
}

// Of finest cages; those of coarser ones follow from them, when these are made.
Result<void> CageTable::readInfluences() {
  const Error too_short = corrupt("the cage table's size does not match its counts", 0);
  std::uint64_t nodes = 0, total = 0;
  for (const CagePlan& plan : plans)
    if (plan.isFinest()) nodes += plan.influences.size();
  if (!arrays.has(nodes)) return too_short;
  const std::span<const std::uint8_t> counts = arrays.bytes(static_cast<std::size_t>(nodes));
  for (const std::uint8_t count : counts) {
    if (count < 1 || count > 4) return corrupt("a node of a cage follows no part, or more than four", 0);
    total += count;
  }
  if (!arrays.has(5 * total - nodes)) return too_short;
  if (total * sizeof(std::uint32_t) > out.room) return tooLarge();
  Buffer<std::uint32_t> parts(out.allocator);
  if (!parts.reset(total)) return outOfMemory("no memory for the cages");
  arrays.numbers(parts.span());
  const std::span<const std::uint8_t> weights = arrays.bytes(static_cast<std::size_t>(total - nodes));
  if (!arrays.done()) return too_short;
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
  return table.make();
}

}  // namespace kelp

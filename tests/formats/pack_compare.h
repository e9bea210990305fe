// SPDX-License-Identifier: MIT
// Reads a whole pack back and compares it with what was written.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "kelp/formats/level.h"
#include "kelp/formats/raw_level.h"
#include "support/naive_cages.h"
#include "support/without_boxes.h"

namespace kelp::test {

// Values that no number of a pack may have.
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// All distances of one level, as the writer was given them.
struct ReadDistances {
  Result<void> status;
  RawDistances level;
};

inline ReadDistances readDistances(const Pack& pack, int part, int level, const Allocator& allocator = {}) {
  ReadDistances out;
  const Result<LevelGrid> grid = pack.readDistanceGrid(part, level);
  if (!grid) {
    out.status = grid.error();
    return out;
  }
  out.level.band = grid->band;
  for (const std::uint32_t cell : grid->cells)
    out.level.cells.push_back(cell & kCellSolid ? kCellSolid | grid->slotOf(cell) : cell);
  PageData page(allocator);
  for (std::size_t i = 0; i < grid->pages.size(); ++i) {
    out.status = pack.readPage(*grid, i, {}, page);
    if (!out.status) return out;
    for (std::uint32_t brick = 0; brick < page.info.count; ++brick) {
      const std::span<const std::uint8_t> codes = page.codes(brick);
      out.level.codes.insert(out.level.codes.end(), codes.begin(), codes.end());
    }
  }
  return out;
}

// Bytes of plain values that have no padding, for exact comparison.
template <class Range>
std::vector<std::byte> bytesOf(const Range& range) {
  std::vector<std::byte> bytes(range.size() * sizeof(*range.data()));
  if (!bytes.empty()) std::memcpy(bytes.data(), range.data(), bytes.size());
  return bytes;
}

// True if the nodes that a morph target moves are those of `exact`, in steps, rounded.
inline bool isMoved(const Morph& morph, const std::vector<glm::dvec3>& exact, float step) {
  std::size_t next = 0;
  for (std::size_t node = 0; node < exact.size(); ++node) {
    glm::dvec3 steps(0);
    if (next < morph.moved.size() && morph.moved[next].node == node)
      steps = glm::dvec3(morph.moved[next++].offset) / static_cast<double>(step);
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(steps[axis] - exact[node][axis]) > 0.501 ||
          std::abs(steps[axis] - std::round(steps[axis])) > 1e-3)
        return false;
  }
  return next == morph.moved.size();
}
inline bool areMorphs(const Part& part, std::size_t cage, const RawPart& raw) {
  const std::span<const Morph> morphs = part.cages[cage].morphs;
  bool same = morphs.size() == raw.morphs.size();
  for (std::size_t m = 0; m < raw.morphs.size() && same; ++m) {
    std::vector<glm::dvec3> exact(part.cages[0].nodes(), glm::dvec3(0));
    for (std::size_t i = 0; i < raw.morphs[m].nodes.size(); ++i)
      exact[raw.morphs[m].nodes[i]] = raw.morphs[m].offsets[i];
    for (std::size_t i = 1; i <= cage; ++i) exact = coarserOffsets(part.cages[i], part.cages[i - 1], exact);
    same = morphs[m].part == raw.morphs[m].part && isMoved(morphs[m], exact, raw.morphs[m].step);
  }
  return same;
}

// True if a cage is as makeCage() makes it of what was written.
inline bool isCage(const Part& part, std::size_t i, const RawPart& raw) {
  CageMemory memory;
  const Cage& cage = part.cages[i];
  const Result<Cage> want =
      makeCage(raw.cages[i].source(), raw.size, static_cast<int>(raw.levels.size()), raw.cell,
               static_cast<int>(i), i > 0 ? &part.cages[i - 1] : nullptr, ~std::uint64_t{0}, memory);
  std::vector<Influences> influences = raw.influences;
  for (std::size_t level = 1; level <= i; ++level)
    influences = coarserInfluences(part.cages[level], part.cages[level - 1], influences);
  return want && areMorphs(part, i, raw) &&
         std::equal(cage.influences.begin(), cage.influences.end(), influences.begin(), influences.end()) &&
         cage.side == want->side && cage.level == want->level && cage.last_level == want->last_level &&
         cage.grid == want->grid && bytesOf(cage.words) == bytesOf(want->words) &&
         bytesOf(cage.places) == bytesOf(want->places) && bytesOf(cage.follows) == bytesOf(want->follows);
}

// Reads everything of a pack, pages into memory of the allocator. status: the first error; equal: whether all
// is what was written.
struct Comparison {
  Result<void> status;
  bool equal = true;
};

inline Comparison compare(const Pack& pack, const RawPack& raw, const Allocator& allocator = {}) {
  Comparison out;
  const auto check = [&](bool same) { out.equal = out.equal && same; };
  check(pack.infoJson() == raw.info_json);
  check(bytesOf(pack.palette()) == bytesOf(raw.palette));
  check(pack.parts().size() == raw.parts.size() && pack.clips().size() == raw.clips.size());
  for (std::size_t p = 0; p < pack.parts().size(); ++p) {
    const Part& a = pack.parts()[p];
    const RawPart b = p < raw.parts.size() ? raw.parts[p] : RawPart();
    check(a.name == b.name && a.parent == b.parent &&
          a.kind == (b.fog              ? PartKind::kFog
                     : b.levels.empty() ? PartKind::kEmpty
                                        : PartKind::kSolid) &&
          a.size == b.size && a.automatic_tangents == b.automatic_tangents && a.parent_at == b.parent_at &&
          a.bend == b.bend && a.roll == b.roll && a.sections == b.sections);
    check((a.fog != nullptr) == b.fog.has_value());
    if (a.fog && b.fog) {
      check(a.fog->color == b.fog->color && a.fog->anisotropy == b.fog->anisotropy &&
            a.fog->glow == b.fog->glow);
      check(bytesOf(a.fog->ramp) == bytesOf(b.fog->ramp) &&
            a.fog->extinction.size() == static_cast<std::size_t>(a.levels));
    }
    check(a.to_object == b.to_object && a.pivot == b.pivot && bytesOf(a.knots) == bytesOf(b.knots));
    check(static_cast<std::size_t>(a.levels) == b.levels.size());
    for (int level = 0; level < a.levels; ++level) {
      const Result<RawLevel> got = readRawLevel(pack, static_cast<int>(p), level, allocator);
      if (!got) {
        out.status = got.error();
        return out;
      }
      const RawLevel want = static_cast<std::size_t>(level) < b.levels.size()
                                ? b.levels[static_cast<std::size_t>(level)]
                                : RawLevel();
      check(withoutBoxes(*got) == withoutBoxes(want) && got->attributes == want.attributes);
      check(got->density == want.density && got->heat == want.heat);
      check(!a.fog || a.fog->extinction[static_cast<std::size_t>(level)] == want.extinction);
    }
    check(a.cages.size() == b.cages.size());
    for (std::size_t i = 0; i < a.cages.size() && out.equal; ++i) check(isCage(a, i, b));
    check(static_cast<std::size_t>(pack.distanceLevels(static_cast<int>(p))) == b.distances.size());
    for (int level = 0; out.equal && level < pack.distanceLevels(static_cast<int>(p)); ++level) {
      const ReadDistances got = readDistances(pack, static_cast<int>(p), level, allocator);
      out.status = got.status;
      if (!out.status) return out;
      const RawDistances& want = b.distances[static_cast<std::size_t>(level)];
      check(got.level.band == want.band && got.level.cells == want.cells && got.level.codes == want.codes);
    }
  }
  if (!out.equal) return out;
  for (std::size_t c = 0; c < raw.clips.size(); ++c) {
    const Clip& a = pack.clips()[c];
    const RawClip& b = raw.clips[c];
    check(a.name == b.name && a.duration == b.duration && a.waves.size() == b.waves.size() &&
          a.tracks.size() == b.tracks.size());
    if (!out.equal) return out;
    for (std::size_t i = 0; i < b.waves.size(); ++i) {
      const Wave &x = a.waves[i], &y = b.waves[i];
      check(x.part == y.part && x.knot == y.knot && x.target == y.target && x.amplitude == y.amplitude &&
            x.period == y.period && x.phase == y.phase);
    }
    for (std::size_t i = 0; i < b.tracks.size(); ++i) {
      const Track& x = a.tracks[i];
      const RawTrack& y = b.tracks[i];
      check(x.part == y.part && x.knot == y.knot && x.target == y.target &&
            x.interpolation == y.interpolation);
      check(bytesOf(x.keys) == bytesOf(y.keys));
    }
  }
  check(pack.sockets().size() == raw.sockets.size());
  if (!out.equal) return out;
  for (std::size_t i = 0; i < raw.sockets.size(); ++i) {
    const Socket& a = pack.sockets()[i];
    const RawSocket& b = raw.sockets[i];
    check(a.name == b.name && a.part == b.part && a.at == b.at && a.offset == b.offset &&
          a.rotation == b.rotation);
  }
  check(pack.joints().size() == raw.joints.size());
  if (!out.equal) return out;
  for (std::size_t i = 0; i < raw.joints.size(); ++i) {
    const Joint& a = pack.joints()[i];
    const RawJoint& b = raw.joints[i];
    check(a.name == b.name && a.parent == b.parent && a.inverse_bind == b.inverse_bind &&
          std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end()));
  }
  return out;
}

}  // namespace kelp::test

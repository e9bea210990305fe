// SPDX-License-Identifier: MIT
// The kernels in vectors: this file is compiled once for every instruction set and the best one is chosen at
// run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels_highway.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstring>

#include "kelp/fields/fields.h"
#include "kernels.h"

HWY_BEFORE_NAMESPACE();
namespace kelp::fields::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// --- first pass

constexpr std::uint16_t kFar = 0xffff;

// distance[x] = 0 where set, else kFar. Answers whether any voxel is set.
HWY_ATTR bool seedRow(const std::uint8_t* HWY_RESTRICT set, int count, std::uint16_t* HWY_RESTRICT distance) {
  const hn::CappedTag<std::uint16_t, 128> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto seen = hn::Zero(d);
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto voxels = hn::PromoteTo(d, hn::LoadU(bytes, set + x));
    seen = hn::Or(seen, voxels);
    hn::StoreU(hn::IfThenElseZero(hn::Eq(voxels, hn::Zero(d)), hn::Set(d, kFar)), d, distance + x);
  }
  bool any = !hn::AllTrue(d, hn::Eq(seen, hn::Zero(d)));
  for (; x < count; ++x) {
    distance[x] = set[x] ? 0 : kFar;
    any |= set[x] != 0;
  }
  return any;
}

// next[x] = min(now[x], now[x - shift] + shift, now[x + shift] + shift); answers whether all of next are
// below 2 * shift.
HWY_ATTR bool relaxRow(const std::uint16_t* HWY_RESTRICT now, int count, int shift,
                       std::uint16_t* HWY_RESTRICT next) {
  const hn::CappedTag<std::uint16_t, 128> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto cost = hn::Set(d, static_cast<std::uint16_t>(shift));
  auto farthest = hn::Zero(d);
  for (int x = 0; x < count; x += lanes) {
    const auto beside =
        hn::SaturatedAdd(hn::Min(hn::LoadU(d, now + x - shift), hn::LoadU(d, now + x + shift)), cost);
    const auto best = hn::Min(hn::LoadU(d, now + x), beside);
    farthest = hn::Max(farthest, best);
    hn::StoreU(best, d, next + x);
  }
  return hn::AllTrue(d, hn::Lt(farthest, hn::Set(d, static_cast<std::uint16_t>(2 * shift))));
}

HWY_ATTR void squareRow(const std::uint16_t* HWY_RESTRICT distance, int count,
                        std::uint32_t* HWY_RESTRICT squared) {
  const hn::CappedTag<std::uint32_t, 64> d;
  const hn::Rebind<std::uint16_t, decltype(d)> narrow;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto wide = hn::PromoteTo(d, hn::LoadU(narrow, distance + x));
    hn::StoreU(hn::Mul(wide, wide), d, squared + x);
  }
  for (; x < count; ++x) squared[x] = std::uint32_t{distance[x]} * distance[x];
}

// Shifts by 1, 2, 4, ... in both directions: every distance is a sum of such shifts, each taken or not, so a
// row of n voxels needs log2(n) sweeps without any dependency from voxel to voxel. It is done as soon as no
// distance is left that a longer shift could change.
HWY_ATTR void rows(const std::uint8_t* set, int count, int row_count, std::uint16_t* scratch,
                   std::uint32_t* squared) {
  // Two buffers, with room beyond the ends for the longest shift and for the last vector.
  int margin = 1;
  while (2 * margin < count) margin *= 2;
  const int buffer = count + 2 * margin + 128;
  std::memset(scratch, 0xff, 2 * static_cast<std::size_t>(buffer) * sizeof(*scratch));
  for (int r = 0; r < row_count; ++r, set += count, squared += count) {
    std::uint16_t* now = scratch + margin;
    std::uint16_t* next = now + buffer;
    if (!seedRow(set, count, now)) {
      std::memset(squared, 0xff, static_cast<std::size_t>(count) * sizeof(*squared));
      continue;
    }
    // Whole vectors run over the row's end and leave distances to this row's voxels there; those of the row
    // before must go.
    std::memset(now + count, 0xff, 128 * sizeof(*now));
    std::memset(next + count, 0xff, 128 * sizeof(*next));
    bool done = false;
    for (int shift = 1; shift < count && !done; shift *= 2) {
      done = relaxRow(now, count, shift, next);
      std::uint16_t* const swap = now;
      now = next;
      next = swap;
    }
    squareRow(now, count, squared);
  }
}

// --- further passes

using Lane = hn::CappedTag<std::int32_t, kTileWidth>;
using Lanes32 = hn::Vec<Lane>;

// `count` values, the rest of the vector filled with -1 (kNoFeature).
HWY_ATTR HWY_INLINE Lanes32 loadSome(Lane d, const std::uint32_t* from, int count) {
  const auto* const values = reinterpret_cast<const std::int32_t*>(from);
  if (count >= static_cast<int>(hn::Lanes(d))) return hn::LoadU(d, values);
  HWY_ALIGN std::int32_t some[kTileWidth];
  hn::Store(hn::Set(d, -1), d, some);
  std::memcpy(some, values, static_cast<std::size_t>(count) * sizeof(*some));
  return hn::Load(d, some);
}

HWY_ATTR HWY_INLINE void storeSome(Lanes32 v, Lane d, std::uint32_t* to, int count) {
  auto* const values = reinterpret_cast<std::int32_t*>(to);
  if (count >= static_cast<int>(hn::Lanes(d))) return hn::StoreU(v, d, values);
  HWY_ALIGN std::int32_t some[kTileWidth];
  hn::Store(v, d, some);
  std::memcpy(values, some, static_cast<std::size_t>(count) * sizeof(*some));
}

// The rows of a z tile lie far apart, which hardware prefetchers do not follow.
constexpr int kAhead = 8;
HWY_INLINE void prefetchRow(const std::uint32_t* row, int width) {
  for (int x = 0; x < width; x += 16) hwy::Prefetch(row + x);
}

// Lower envelopes after Meijster, Roerdink and Hesselink 2000, one pencil a lane. Two things differ from the
// scalar algorithm:
// - A parabola enters a stack at most once, at its own row. So the stack is a list through the rows: links[u]
//   holds the parabola below u (upper 16 bits, -1 at the bottom) and the first row at which that one is the
//   lowest (lower 16 bits). A push is a store of a full vector; only a pop gathers.
// - A parabola is kept as g = f + u^2, its value at i being g + i (i - 2 u). Two of them are compared at the
//   start s of the upper one by g_top + 2 s (u - top) > g_u, with one product.
// Each lane pops at most once for each of its pushes, so the work is linear in the worst case too.
struct Stacks {
  std::int32_t* heights;  // g of every row, kTileWidth a row
  std::int32_t* links;
  // The top of each lane's stack. All vectors of a row are treated before the next row, so that their
  // latencies overlap.
  HWY_ALIGN std::int32_t tops[kTileWidth], starts[kTileWidth], top_heights[kTileWidth];
  bool solid[kTileWidth];  // all of the vector's lanes are set in the row before
};

// The top parabola of the lanes of one vector: its row (-1: none), where it begins to be the lowest, its g.
struct Top {
  Lanes32 row, start, height;
};

HWY_ATTR HWY_INLINE Top loadTop(const Stacks& stacks, Lane d, int x) {
  return {hn::Load(d, stacks.tops + x), hn::Load(d, stacks.starts + x), hn::Load(d, stacks.top_heights + x)};
}
HWY_ATTR HWY_INLINE void storeTop(const Top& top, Lane d, int x, Stacks& stacks) {
  hn::Store(top.row, d, stacks.tops + x);
  hn::Store(top.start, d, stacks.starts + x);
  hn::Store(top.height, d, stacks.top_heights + x);
}

// The index of row `row` in the lanes of `mask`, of row 0 in the others: nothing harmful lies there.
HWY_ATTR HWY_INLINE Lanes32 rowIndex(hn::Mask<Lane> mask, Lanes32 row, Lanes32 lane_index) {
  static_assert(kTileWidth == 1 << 6);
  return hn::Add(hn::IfThenElseZero(mask, hn::ShiftLeft<6>(row)), lane_index);
}

// Inside a solid: the row before is on top everywhere, and gives way to row u.
HWY_ATTR HWY_INLINE void pushInsideSolid(Stacks& stacks, Lane d, int x, int u) {
  const std::size_t at = static_cast<std::size_t>(u) * kTileWidth + static_cast<std::size_t>(x);
  const auto here = hn::Set(d, u), height = hn::Set(d, u * u);
  hn::StoreU(height, d, stacks.heights + at);
  hn::StoreU(hn::Or(hn::Set(d, (u - 1) << 16), hn::Load(d, stacks.starts + x)), d, stacks.links + at);
  storeTop({here, here, height}, d, x, stacks);
}

// Takes the tops that the parabola of row u hides from the lanes of `live`.
HWY_ATTR HWY_INLINE Top popHidden(const Stacks& stacks, Lane d, int x, int u, Lanes32 height,
                                  hn::Mask<Lane> live) {
  const auto none = hn::Set(d, -1), here = hn::Set(d, u), lane_index = hn::Iota(d, x);
  Top top = loadTop(stacks, d, x);
  auto candidates = hn::And(live, hn::Gt(top.row, none));
  for (;;) {
    const auto reach = hn::Mul(hn::Add(top.start, top.start), hn::Sub(here, top.row));
    const auto pop = hn::And(candidates, hn::Gt(hn::Add(top.height, reach), height));
    if (hn::AllFalse(d, pop)) return top;
    const auto link = hn::GatherIndex(d, stacks.links, rowIndex(pop, top.row, lane_index));
    top.row = hn::IfThenElse(pop, hn::ShiftRight<16>(link), top.row);
    top.start = hn::IfThenElse(pop, hn::And(link, hn::Set(d, 0xffff)), top.start);
    candidates = hn::And(pop, hn::Gt(top.row, none));
    const auto below = hn::GatherIndex(d, stacks.heights, rowIndex(candidates, top.row, lane_index));
    top.height = hn::IfThenElse(candidates, below, top.height);
  }
}

// The first row at which the parabola of row u is lower than the top: floor((g_u - g_top) / 2 / (u - top)) +
// 1, by a float division and a correction; 0 where there is no top. The quotient is at most `count` < 2^15 or
// clamped to it, so the float is wrong by less than one.
HWY_ATTR HWY_INLINE Lanes32 firstRow(const Top& top, Lane d, int u, int count, Lanes32 height) {
  const hn::Rebind<float, Lane> df;
  const auto zero = hn::Zero(d), none = hn::Set(d, -1);
  const auto distance = hn::Sub(hn::Set(d, u), top.row);
  const auto half = hn::ShiftRight<1>(hn::Sub(height, top.height));
  auto last = hn::ConvertTo(d, hn::Min(hn::Div(hn::ConvertTo(df, half), hn::ConvertTo(df, distance)),
                                       hn::Set(df, static_cast<float>(count))));
  const auto rest = hn::Sub(half, hn::Mul(last, distance));
  last = hn::Add(last, hn::VecFromMask(d, hn::Lt(rest, zero)));
  last = hn::Sub(last, hn::VecFromMask(d, hn::Gt(rest, hn::Add(distance, none))));
  return hn::IfThenZeroElse(hn::Lt(top.row, zero), hn::Sub(last, none));
}

// Row u enters the stacks of one vector of lanes.
HWY_ATTR HWY_INLINE void pushRow(const std::uint32_t* from, std::size_t stride, int count, int left, int x,
                                 int u, Stacks& stacks) {
  const Lane d;
  const auto zero = hn::Zero(d), none = hn::Set(d, -1);
  const auto f = loadSome(d, from, left);
  const bool solid_before = stacks.solid[x];
  stacks.solid[x] = hn::AllTrue(d, hn::Eq(f, zero));
  if (solid_before && stacks.solid[x]) return pushInsideSolid(stacks, d, x, u);
  auto live = hn::Gt(f, none);
  if (u > 0 && u + 1 < count) {
    // A peak is nowhere the lowest.
    const auto before = loadSome(d, from - stride, left), after = loadSome(d, from + stride, left);
    const auto lesser = hn::Min(before, after);
    const auto peak = hn::And(hn::And(hn::Gt(lesser, none), hn::Gt(f, lesser)),
                              hn::Gt(hn::Add(f, hn::Set(d, 1)), hn::Max(before, after)));
    live = hn::AndNot(peak, live);
  }
  if (hn::AllFalse(d, live)) return;
  const std::size_t at = static_cast<std::size_t>(u) * kTileWidth + static_cast<std::size_t>(x);
  const auto height = hn::Add(f, hn::Set(d, u * u));
  hn::StoreU(height, d, stacks.heights + at);
  const Top top = popHidden(stacks, d, x, u, height, live);
  const auto first = firstRow(top, d, u, count, height);
  const auto push = hn::And(live, hn::Lt(first, hn::Set(d, count)));
  hn::StoreU(hn::Or(hn::ShiftLeft<16>(top.row), top.start), d, stacks.links + at);
  storeTop({hn::IfThenElse(push, hn::Set(d, u), top.row), hn::IfThenElse(push, first, top.start),
            hn::IfThenElse(push, height, top.height)},
           d, x, stacks);
}

// Writes the envelopes of one vector of lanes, from the last row back to the first.
HWY_ATTR HWY_INLINE void writeEnvelope(std::uint32_t* values, std::size_t stride, int count, int left, int x,
                                       const Stacks& stacks) {
  const Lane d;
  const auto zero = hn::Zero(d), none = hn::Set(d, -1), lane_index = hn::Iota(d, x);
  Top top = loadTop(stacks, d, x);
  // Pencils without any parabola stay as they are: all kNoFeature.
  const auto empty = hn::Lt(top.row, zero);
  if (hn::AllTrue(d, empty)) return;
  bool solid_here = false;
  for (int i = count - 1; i >= 0; --i) {
    std::uint32_t* const to = values + static_cast<std::size_t>(i) * stride;
    const auto here = hn::Set(d, i);
    if (!solid_here) {
      const auto value = hn::Add(top.height, hn::Mul(here, hn::Sub(here, hn::Add(top.row, top.row))));
      storeSome(hn::IfThenElse(empty, none, value), d, to, left);
    }
    if (i == 0) break;
    // Inside a solid every parabola begins at its own row: nothing to write, and nothing to gather.
    const bool solid_above = solid_here;
    solid_here = hn::AllTrue(d, hn::Eq(loadSome(d, to - stride, left), zero));
    if (solid_above && solid_here) {
      const std::size_t at = static_cast<std::size_t>(i) * kTileWidth + static_cast<std::size_t>(x);
      top.start = hn::And(hn::LoadU(d, stacks.links + at), hn::Set(d, 0xffff));
      top.row = hn::Set(d, i - 1);
      top.height = hn::Set(d, (i - 1) * (i - 1));
      continue;
    }
    const auto pop = hn::AndNot(empty, hn::Eq(top.start, here));
    if (hn::AllFalse(d, pop)) continue;
    const auto link = hn::GatherIndex(d, stacks.links, rowIndex(pop, top.row, lane_index));
    top.row = hn::IfThenElse(pop, hn::ShiftRight<16>(link), top.row);
    top.start = hn::IfThenElse(pop, hn::And(link, hn::Set(d, 0xffff)), top.start);
    const auto below = hn::GatherIndex(d, stacks.heights, rowIndex(pop, top.row, lane_index));
    top.height = hn::IfThenElse(pop, below, top.height);
  }
}

HWY_ATTR void envelopes(std::uint32_t* values, std::size_t stride, int count, int width,
                        std::int32_t* scratch) {
  const Lane d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Stacks stacks;
  stacks.heights = scratch;
  stacks.links = scratch + static_cast<std::size_t>(count) * kTileWidth;
  for (int x = 0; x < width; x += lanes) {
    storeTop({hn::Set(d, -1), hn::Zero(d), hn::Zero(d)}, d, x, stacks);
    stacks.solid[x] = false;
  }
  for (int u = 0; u < count; ++u) {
    const std::uint32_t* const row = values + static_cast<std::size_t>(u) * stride;
    if (u + kAhead < count) prefetchRow(row + kAhead * stride, width);
    for (int x = 0; x < width; x += lanes) pushRow(row + x, stride, count, width - x, x, u, stacks);
  }
  for (int x = 0; x < width; x += lanes) writeEnvelope(values + x, stride, count, width - x, x, stacks);
}

// --- neighborhoods

HWY_ATTR void largest(const std::uint8_t* const* in, int row_count, int count, std::uint8_t* scratch,
                      std::uint8_t* out) {
  const auto greater = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
  const hn::CappedTag<std::uint8_t, 256> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::uint8_t* const across = scratch + 1;
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    auto best = hn::LoadU(d, in[0] + x);
    for (int r = 1; r < row_count; ++r) best = hn::Max(best, hn::LoadU(d, in[r] + x));
    hn::StoreU(best, d, across + x);
  }
  for (; x < count; ++x) {
    std::uint8_t best = in[0][x];
    for (int r = 1; r < row_count; ++r) best = greater(best, in[r][x]);
    across[x] = best;
  }
  across[-1] = across[count] = 0;
  for (x = 0; x + lanes <= count; x += lanes) {
    const auto sides = hn::Max(hn::LoadU(d, across + x - 1), hn::LoadU(d, across + x + 1));
    hn::StoreU(hn::Max(hn::LoadU(d, across + x), sides), d, out + x);
  }
  for (; x < count; ++x) out[x] = greater(across[x], greater(across[x - 1], across[x + 1]));
}

// --- a bit a byte

HWY_ATTR void bits(const std::uint8_t* bytes, int count, std::uint64_t* words) {
  const hn::CappedTag<std::uint8_t, 64> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  if (lanes < 8) return plainKernels().bits(bytes, count, words);  // no vectors at all
  for (int x = 0; x < count; x += 64, bytes += 64) {
    std::uint8_t last[64] = {};
    if (count - x < 64) std::memcpy(last, bytes, static_cast<std::size_t>(count - x));
    const std::uint8_t* const from = count - x < 64 ? last : bytes;
    std::uint8_t eights[8 + 8] = {};  // with room for what a store may write beyond its bits
    for (int i = 0; i < 64; i += lanes)
      hn::StoreMaskBits(d, hn::Ne(hn::LoadU(d, from + i), hn::Zero(d)), eights + i / 8);
    std::uint64_t word = 0;
    for (int i = 0; i < 8; ++i) word |= std::uint64_t{eights[i]} << (8 * i);
    words[x / 64] = word;
  }
}

}  // namespace

const Kernels* table() {
  static constexpr Kernels kernels{rows, envelopes, largest, bits};
  return &kernels;
}

}  // namespace kelp::fields::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelp::fields {

HWY_EXPORT(table);

const Kernels& fastKernels() { return *HWY_DYNAMIC_DISPATCH(table)(); }

}  // namespace kelp::fields
#endif  // HWY_ONCE

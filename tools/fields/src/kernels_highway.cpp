// SPDX-License-Identifier: MIT
// The kernels in vectors: this file is compiled once for every instruction set and the best one is chosen at run time.
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
// ------------------------------------------------------------------------------------------------------------------

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

// next[x] = min(now[x], now[x - shift] + shift, now[x + shift] + shift); answers whether all of next are below 2 * shift.
HWY_ATTR bool relaxRow(const std::uint16_t* HWY_RESTRICT now, int count, int shift, std::uint16_t* HWY_RESTRICT next) {
  const hn::CappedTag<std::uint16_t, 128> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto cost = hn::Set(d, static_cast<std::uint16_t>(shift));
  auto farthest = hn::Zero(d);
  for (int x = 0; x < count; x += lanes) {
    const auto beside = hn::SaturatedAdd(hn::Min(hn::LoadU(d, now + x - shift), hn::LoadU(d, now + x + shift)), cost);
    const auto best = hn::Min(hn::LoadU(d, now + x), beside);
    farthest = hn::Max(farthest, best);
    hn::StoreU(best, d, next + x);
  }
  return hn::AllTrue(d, hn::Lt(farthest, hn::Set(d, static_cast<std::uint16_t>(2 * shift))));
}

HWY_ATTR void squareRow(const std::uint16_t* HWY_RESTRICT distance, int count, std::uint32_t* HWY_RESTRICT squared) {
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

// Shifts by 1, 2, 4, ... in both directions: every distance is a sum of such shifts, each taken or not, so a row of n voxels
// needs log2(n) sweeps without any dependency from voxel to voxel. It is done as soon as no distance is left that a longer shift
// could change.
HWY_ATTR void rows(const std::uint8_t* set, int count, int row_count, std::uint16_t* scratch, std::uint32_t* squared) {
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
    // Whole vectors run over the row's end and leave distances to this row's voxels there; those of the row before must go.
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
// --------------------------------------------------------------------------------------------------------------

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

// Lower envelopes after Meijster, Roerdink and Hesselink 2000, one pencil a lane. Two things differ from the scalar algorithm:
// - A parabola enters a stack at most once, at its own row. So the stack is a list through the rows: links[u] holds the parabola
// below u
//   (upper 16 bits, -1 at the bottom) and the first row at which that one is the lowest (lower 16 bits). A push is a store of a
//   full vector; only a pop gathers.
// - A parabola is kept as g = f + u^2, its value at i being g + i (i - 2 u): comparing two of them at the start s of the upper
// one is
//   g_top + 2 s (u - top) > g_u, with one product.
// Each lane pops at most once for each of its pushes, so the work is linear in the worst case too.
HWY_ATTR void envelopes(std::uint32_t* values, std::size_t stride, int count, int width, std::int32_t* scratch) {
  const Lane d;
  const hn::Rebind<float, Lane> df;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::int32_t* const heights = scratch;  // g
  std::int32_t* const links = scratch + static_cast<std::size_t>(count) * kTileWidth;
  // The top of each lane's stack. All vectors of a row are treated before the next row, so that their latencies overlap.
  HWY_ALIGN std::int32_t tops[kTileWidth], starts[kTileWidth], top_heights[kTileWidth];
  bool solid[kTileWidth] = {};  // all of the vector's lanes are set in the row before
  const auto zero = hn::Zero(d);
  const auto none = hn::Set(d, -1);
  const auto one = hn::Set(d, 1);
  for (int x = 0; x < width; x += lanes) {
    hn::Store(none, d, tops + x);
    hn::Store(zero, d, starts + x);
    hn::Store(zero, d, top_heights + x);
  }

  const auto rows_f = hn::Set(df, static_cast<float>(count));
  const auto rows_i = hn::Set(d, count);
  for (int u = 0; u < count; ++u) {
    const std::size_t row = static_cast<std::size_t>(u) * kTileWidth;
    if (u + kAhead < count) prefetchRow(values + static_cast<std::size_t>(u + kAhead) * stride, width);
    const auto here = hn::Set(d, u);
    const auto here_squared = hn::Set(d, u * u);
    for (int x = 0; x < width; x += lanes) {
      const std::uint32_t* const from = values + static_cast<std::size_t>(u) * stride + x;
      const auto f = loadSome(d, from, width - x);
      // Inside a solid: the row before is on top everywhere, and gives way here.
      const bool solid_before = solid[x];
      solid[x] = hn::AllTrue(d, hn::Eq(f, zero));
      if (solid_before && solid[x]) {
        hn::StoreU(here_squared, d, heights + row + x);
        hn::StoreU(hn::Or(hn::Set(d, (u - 1) << 16), hn::Load(d, starts + x)), d, links + row + x);
        hn::Store(here, d, tops + x);
        hn::Store(here, d, starts + x);
        hn::Store(here_squared, d, top_heights + x);
        continue;
      }
      auto live = hn::Gt(f, none);
      if (u > 0 && u + 1 < count) {
        const auto before = loadSome(d, from - stride, width - x);
        const auto after = loadSome(d, from + stride, width - x);
        const auto lesser = hn::Min(before, after);
        const auto peak =
            hn::And(hn::And(hn::Gt(lesser, none), hn::Gt(f, lesser)), hn::Gt(hn::Add(f, one), hn::Max(before, after)));
        live = hn::AndNot(peak, live);
      }
      if (hn::AllFalse(d, live)) continue;
      const auto height = hn::Add(f, here_squared);
      hn::StoreU(height, d, heights + row + x);

      auto top = hn::Load(d, tops + x);
      auto start = hn::Load(d, starts + x);
      auto top_height = hn::Load(d, top_heights + x);
      const auto lane_index = hn::Iota(d, x);
      auto candidates = hn::And(live, hn::Gt(top, none));
      for (;;) {
        const auto reach = hn::Mul(hn::Add(start, start), hn::Sub(here, top));
        const auto pop = hn::And(candidates, hn::Gt(hn::Add(top_height, reach), height));
        if (hn::AllFalse(d, pop)) break;
        // Lanes that do not pop gather from their first row, where nothing harmful lies.
        const auto link = hn::GatherIndex(d, links, hn::Add(hn::IfThenElseZero(pop, hn::ShiftLeft<6>(top)), lane_index));
        top = hn::IfThenElse(pop, hn::ShiftRight<16>(link), top);
        start = hn::IfThenElse(pop, hn::And(link, hn::Set(d, 0xffff)), start);
        candidates = hn::And(pop, hn::Gt(top, none));
        const auto below =
            hn::GatherIndex(d, heights, hn::Add(hn::IfThenElseZero(candidates, hn::ShiftLeft<6>(top)), lane_index));
        top_height = hn::IfThenElse(candidates, below, top_height);
      }

      // The last row at which the top is at most the new parabola: floor((g_u - g_top) / 2 / (u - top)), by a float division and
      // a correction. The quotient is at most `count` < 2^15 or clamped to it, so the float is wrong by less than one.
      const auto distance = hn::Sub(here, top);
      const auto half = hn::ShiftRight<1>(hn::Sub(height, top_height));
      auto last = hn::ConvertTo(d, hn::Min(hn::Div(hn::ConvertTo(df, half), hn::ConvertTo(df, distance)), rows_f));
      const auto rest = hn::Sub(half, hn::Mul(last, distance));
      last = hn::Add(last, hn::VecFromMask(d, hn::Lt(rest, zero)));
      last = hn::Sub(last, hn::VecFromMask(d, hn::Gt(rest, hn::Add(distance, none))));
      const auto first = hn::IfThenZeroElse(hn::Lt(top, zero), hn::Sub(last, none));
      const auto push = hn::And(live, hn::Lt(first, rows_i));
      hn::StoreU(hn::Or(hn::ShiftLeft<16>(top), start), d, links + row + x);
      hn::Store(hn::IfThenElse(push, here, top), d, tops + x);
      hn::Store(hn::IfThenElse(push, first, start), d, starts + x);
      hn::Store(hn::IfThenElse(push, height, top_height), d, top_heights + x);
    }
  }

  for (int x = 0; x < width; x += lanes) {
    // Pencils without any parabola stay as they are: all kNoFeature.
    if (hn::AllTrue(d, hn::Lt(hn::Load(d, tops + x), zero))) continue;
    const auto lane_index = hn::Iota(d, x);
    const auto empty = hn::Lt(hn::Load(d, tops + x), zero);
    auto top = hn::Load(d, tops + x);
    auto start = hn::Load(d, starts + x);
    auto height = hn::Load(d, top_heights + x);
    bool solid_here = false;
    for (int i = count - 1; i >= 0; --i) {
      std::uint32_t* const to = values + static_cast<std::size_t>(i) * stride + x;
      const auto here = hn::Set(d, i);
      if (!solid_here) {
        const auto value = hn::Add(height, hn::Mul(here, hn::Sub(here, hn::Add(top, top))));
        storeSome(hn::IfThenElse(empty, none, value), d, to, width - x);
      }
      if (i == 0) break;
      // Inside a solid every parabola begins at its own row: nothing to write, and nothing to gather.
      const bool solid_above = solid_here;
      solid_here = hn::AllTrue(d, hn::Eq(loadSome(d, to - stride, width - x), zero));
      if (solid_above && solid_here) {
        start = hn::And(hn::LoadU(d, links + static_cast<std::size_t>(i) * kTileWidth + x), hn::Set(d, 0xffff));
        top = hn::Set(d, i - 1);
        height = hn::Set(d, (i - 1) * (i - 1));
        continue;
      }
      const auto pop = hn::AndNot(empty, hn::Eq(start, here));
      if (hn::AllFalse(d, pop)) continue;
      const auto link = hn::GatherIndex(d, links, hn::Add(hn::IfThenElseZero(pop, hn::ShiftLeft<6>(top)), lane_index));
      top = hn::IfThenElse(pop, hn::ShiftRight<16>(link), top);
      start = hn::IfThenElse(pop, hn::And(link, hn::Set(d, 0xffff)), start);
      const auto below = hn::GatherIndex(d, heights, hn::Add(hn::IfThenElseZero(pop, hn::ShiftLeft<6>(top)), lane_index));
      height = hn::IfThenElse(pop, below, height);
    }
  }
}

// --- neighbourhoods
// --------------------------------------------------------------------------------------------------------------

struct PickLargest {
  template <class V>
  HWY_ATTR HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
  HWY_INLINE std::uint8_t scalar(std::uint8_t a, std::uint8_t b) const { return a > b ? a : b; }
};

struct PickSmallest {
  template <class V>
  HWY_ATTR HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
  HWY_INLINE std::uint8_t scalar(std::uint8_t a, std::uint8_t b) const { return a < b ? a : b; }
};

template <class Pick>
HWY_ATTR HWY_INLINE void neighbours(const std::uint8_t* const* in, int row_count, int count, std::uint8_t* scratch,
                                    std::uint8_t* out) {
  const Pick pick;
  const hn::CappedTag<std::uint8_t, 256> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::uint8_t* const across = scratch + 1;
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    auto best = hn::LoadU(d, in[0] + x);
    for (int r = 1; r < row_count; ++r) best = pick(best, hn::LoadU(d, in[r] + x));
    hn::StoreU(best, d, across + x);
  }
  for (; x < count; ++x) {
    std::uint8_t best = in[0][x];
    for (int r = 1; r < row_count; ++r) best = pick.scalar(best, in[r][x]);
    across[x] = best;
  }
  across[-1] = across[count] = 0;
  for (x = 0; x + lanes <= count; x += lanes) {
    const auto sides = pick(hn::LoadU(d, across + x - 1), hn::LoadU(d, across + x + 1));
    hn::StoreU(pick(hn::LoadU(d, across + x), sides), d, out + x);
  }
  for (; x < count; ++x) out[x] = pick.scalar(across[x], pick.scalar(across[x - 1], across[x + 1]));
}

HWY_ATTR void largest(const std::uint8_t* const* in, int row_count, int count, std::uint8_t* scratch, std::uint8_t* out) {
  neighbours<PickLargest>(in, row_count, count, scratch, out);
}

HWY_ATTR void smallest(const std::uint8_t* const* in, int row_count, int count, std::uint8_t* scratch, std::uint8_t* out) {
  neighbours<PickSmallest>(in, row_count, count, scratch, out);
}

}  // namespace

const Kernels* table() {
  static constexpr Kernels kernels{rows, envelopes, largest, smallest};
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

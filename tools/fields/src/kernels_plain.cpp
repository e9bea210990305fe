// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "kelp/fields/fields.h"
#include "kernels.h"

namespace kelp::fields {
namespace {

void row(const std::uint8_t* set, int count, std::uint32_t* squared) {
  // Distances to the left, then the lesser of those and the ones to the right. kMaxSide is farther than any
  // voxel of the row.
  std::uint32_t distance = kMaxSide;
  for (int x = 0; x < count; ++x) {
    distance = set[x] ? 0 : std::min<std::uint32_t>(distance + 1, kMaxSide);
    squared[x] = distance;
  }
  distance = kMaxSide;
  for (int x = count - 1; x >= 0; --x) {
    distance = std::min(squared[x], std::min<std::uint32_t>(distance + 1, kMaxSide));
    squared[x] = distance == kMaxSide ? kNoFeature : distance * distance;
  }
}

void rows(const std::uint8_t* set, int count, int row_count, std::uint16_t*, std::uint32_t* squared) {
  for (int r = 0; r < row_count; ++r, set += count, squared += count) row(set, count, squared);
}

// Lower envelope of the parabolas f[j] + (i - j)^2 of one pencil, after Meijster, Roerdink and Hesselink
// 2000. `vertex` and `start` are the stack: which parabola, and the first i at which it is the lowest.
void envelope(const std::uint32_t* f, int count, std::int32_t* vertex, std::int32_t* start,
              std::uint32_t* out, std::size_t stride) {
  const auto value = [&](std::int64_t j, std::int64_t i) { return f[j] + (i - j) * (i - j); };
  int top = -1;
  for (int u = 0; u < count; ++u) {
    if (f[u] == kNoFeature) continue;
    while (top >= 0 && value(vertex[top], start[top]) > value(u, start[top])) --top;
    std::int64_t first = 0;
    if (top >= 0) {
      // The last i at which the parabola below is at most the new one. Not negative: it holds at start[top].
      const std::int64_t v = vertex[top];
      first = 1 + (std::int64_t{u} * u - v * v + f[u] - f[v]) / (2 * (u - v));
    }
    if (first >= count) continue;
    ++top;
    vertex[top] = u;
    start[top] = static_cast<std::int32_t>(first);
  }
  if (top < 0) return;  // nothing set: what is there stays
  for (int i = count - 1; i >= 0; --i) {
    out[static_cast<std::size_t>(i) * stride] = static_cast<std::uint32_t>(value(vertex[top], i));
    if (start[top] == i) --top;
  }
}

void envelopes(std::uint32_t* values, std::size_t stride, int count, int width, std::int32_t* scratch) {
  const auto length = static_cast<std::size_t>(count);
  // The tile, turned: reading and writing it row by row touches every cache line once.
  auto* const pencils = reinterpret_cast<std::uint32_t*>(scratch);
  for (std::size_t i = 0; i < length; ++i) {
    for (int x = 0; x < width; ++x)
      pencils[static_cast<std::size_t>(x) * length + i] = values[i * stride + static_cast<std::size_t>(x)];
  }
  std::int32_t* const vertex = scratch + length * kTileWidth;
  for (int x = 0; x < width; ++x)
    envelope(pencils + static_cast<std::size_t>(x) * length, count, vertex, vertex + length, values + x,
             stride);
}

void largest(const std::uint8_t* const* rows, int row_count, int count, std::uint8_t* scratch,
             std::uint8_t* out) {
  std::uint8_t* const across = scratch + 1;
  std::memcpy(across, rows[0], static_cast<std::size_t>(count));
  for (int r = 1; r < row_count; ++r) {
    for (int x = 0; x < count; ++x) across[x] = std::max(across[x], rows[r][x]);
  }
  across[-1] = across[count] = 0;
  for (int x = 0; x < count; ++x) out[x] = std::max(across[x], std::max(across[x - 1], across[x + 1]));
}

void bits(const std::uint8_t* bytes, int count, std::uint64_t* words) {
  for (int x = 0; x < count; x += 64) {
    std::uint64_t word = 0;
    for (int i = 0; i < std::min(64, count - x); ++i) word |= std::uint64_t{bytes[x + i] != 0} << i;
    words[x / 64] = word;
  }
}

}  // namespace

const Kernels& plainKernels() {
  static constexpr Kernels kernels{rows, envelopes, largest, bits};
  return kernels;
}

}  // namespace kelp::fields

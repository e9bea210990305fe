// SPDX-License-Identifier: MIT
// Which voxels of a page are solid, and which of them surface: coded alike by encoder and decoder.
#pragma once

#include "page_state.h"

namespace kelp::coding {

// How much each of the 26 voxels around says that a voxel is solid (if it is solid) or empty (if it is
// empty), in the order of x, then y, then z. The sum of all reaches from -127 to 127.
inline constexpr std::array<std::int8_t, 27> kWeights = {-4, 1,  -10, 2,  10, 2, 3, 7, -2,  // z - 1
                                                         4,  18, 7,   18, 0,  4, 4, 4, 10,  // z
                                                         -2, 7,  3,   6,  10, 2, 2, 9, 7};  // z + 1
inline constexpr int kWeightBias = 11;

// The weight that a row of the nine gives to two voxels beside each other: the sum of three weights of the
// first in the low half, that of the second in the high half, by the 8 bits of the four voxels there.
inline constexpr std::array<std::array<std::int32_t, 256>, 9> kPairWeights = [] {
  std::array<std::array<std::int32_t, 256>, 9> sums{};
  for (std::size_t row = 0; row < 9; ++row)
    for (std::size_t bits = 0; bits < 256; ++bits)
      for (std::size_t at = 0; at < 6; ++at) {
        const std::size_t second = at / 3, x = at % 3, state = bits >> (2 * (x + second)) & 3;
        const int weight = kWeights[3 * row + x];
        sums[row][bits] += (state == kSolid ? weight : state == kEmpty ? -weight : 0) * (second ? 65536 : 1);
      }
  return sums;
}();
inline constexpr int kWeightBefore = kWeights[12];  // of the voxel before, in the same row

inline constexpr std::uint32_t kEachVoxel = 0x55555;  // of a window's row

// 8 bits as the low bits of 8 voxels.
inline std::uint32_t spreadRow(std::uint32_t bits) {
  bits = (bits | bits << 4) & 0x0f0f;
  bits = (bits | bits << 2) & 0x3333;
  return (bits | bits << 1) & 0x5555;
}
// 4 bits of a coarse row as the low bits of 8 voxels.
inline std::uint32_t spreadCoarse(std::uint32_t bits) {
  bits = (bits | bits << 6) & 0x0303;
  bits = (bits | bits << 3) & 0x1111;
  return bits | bits << 2;
}
// The low bits of 8 voxels, together.
inline std::uint32_t gatherRow(std::uint32_t bits) {
  bits &= 0x5555;
  bits = (bits | bits >> 1) & 0x3333;
  bits = (bits | bits >> 2) & 0x0f0f;
  return (bits | bits >> 4) & 0xff;
}
// Row y of slice z of a block, of 4 each.
inline std::uint32_t coarseRow(std::uint64_t block, std::size_t y, std::size_t z) {
  return static_cast<std::uint32_t>(block >> (4 * y + 16 * z)) & 15;
}

// Marks the voxels that follow from the coarser level and the level's size as known.
inline void startRows(const PageShape& shape, PageState& state) {
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    const glm::ivec3 room = shape.size - shape.bricks[b] * 8;
    const std::uint32_t in_row = room.x >= 8 ? 0xffff : (1u << (2 * room.x)) - 1;
    for (std::size_t four = 0; four < 16; ++four) {  // rows under the same coarse row
      const std::size_t y = four % 4, z = four / 4;
      std::uint32_t bits = 0;
      if (!shape.above.empty()) {
        const CoarseBlock& block = shape.above[b];
        bits = spreadCoarse(~coarseRow(block.solid, y, z) & 15) |
               spreadCoarse(coarseRow(block.solid & ~block.surface, y, z)) << 1;
      }
      bits = (bits & in_row) | (0x5555 & ~in_row);
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t fine_y = 2 * y + i % 2, fine_z = 2 * z + i / 2;
        const bool inside = static_cast<int>(fine_y) < room.y && static_cast<int>(fine_z) < room.z;
        state.rows[b][fine_y + 8 * fine_z] = static_cast<std::uint16_t>(inside ? bits : 0x5555);
      }
    }
  }
}

inline void lookAround(const PageState& state, std::size_t brick, Window& window) {
  std::array<const std::uint16_t*, 27> bricks;
  for (std::size_t i = 0; i < 27; ++i) {
    const int there = state.around[brick][i];
    bricks[i] = (there >= 0    ? state.rows[static_cast<std::size_t>(there)]
                 : there == -1 ? kUnknownRows
                               : kEmptyRows)
                    .data();
  }
  for (std::size_t z = 7; z < 17; ++z) {
    for (std::size_t y = 7; y < 17; ++y) {
      const std::uint16_t* const* const three = &bricks[(y >> 3) * 3 + (z >> 3) * 9];
      const std::size_t row = (y & 7) + 8 * (z & 7);
      window[z - 7][y - 7] = std::uint32_t{three[0][row]} >> 14 | std::uint32_t{three[1][row]} << 2 |
                             (std::uint32_t{three[2][row]} & 3) << 18;
    }
  }
}

// Codes the unknown voxels of a row.
template <class Coder>
void codeSolidRow(Coder& coder, Models& models, Window& window, std::size_t y, std::size_t z,
                  std::uint64_t truth, bool coarsest) {
  std::uint32_t& row = window[z + 1][y + 1];
  const auto isUnknown = [&](std::size_t x) { return (row >> (2 * x + 2) & 3) == kUnknown; };
  for (std::size_t pair = 0; pair < 8; pair += 2) {
    if (!isUnknown(pair) && !isUnknown(pair + 1)) continue;
    std::int32_t both = 0;
    for (std::size_t r = 0; r < 9; ++r)
      both += kPairWeights[r][window[z + r / 3][y + r % 3] >> (2 * pair) & 255];
    const auto first = static_cast<std::int16_t>(both);
    std::array<int, 2> sums = {kWeightBias + first, kWeightBias + ((both - first) >> 16)};
    for (std::size_t x = pair; x < pair + 2; ++x) {
      if (!isUnknown(x)) continue;
      bool solid;
      if (!coarsest && (x & y & z & 1) && (window[z][y] >> (2 * x) & 15) == 5 &&
          (window[z][y + 1] >> (2 * x) & 15) == 5 && (window[z + 1][y] >> (2 * x) & 15) == 5 &&
          (row >> (2 * x) & 3) == kEmpty) {
        solid = true;  // the last of a block that is not empty
      } else {
        const int sum = sums[x & 1];
        const auto bin = static_cast<std::size_t>(sum < -64 ? 0 : sum > 63 ? kBins - 1 : (sum + 64) >> 3);
        solid = coder.bit(models.solid[(x & 1) | (y & 1) << 1 | (z & 1) << 2][bin], (truth >> x & 1) != 0);
      }
      row |= (solid ? kSolid : kEmpty) << (2 * x + 2);
      sums[1] += x == pair ? (solid ? kWeightBefore : -kWeightBefore) : 0;
    }
  }
}

template <class Coder>
void codeSolid(Coder& shared, const PageShape& shape, PageState& state) {
  Coder coder = shared;
  Window window;
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    lookAround(state, b, window);
    for (std::size_t z = 0; z < 8; ++z) {
      std::uint64_t slice = 0;
      for (std::size_t y = 0; y < 8; ++y) {
        const std::uint32_t before = state.rows[b][y + 8 * z];
        const std::uint32_t open = ~(before | before >> 1) & 0x5555;
        if (open != 0) {
          const std::uint64_t truth = Coder::kDecodes ? 0 : state.solid[b][z] >> (8 * y);
          codeSolidRow(coder, state.models, window, y, z, truth, shape.above.empty());
          state.rows[b][y + 8 * z] = static_cast<std::uint16_t>(window[z + 1][y + 1] >> 2);
        }
        if (Coder::kDecodes)
          slice |= std::uint64_t{gatherRow(std::uint32_t{state.rows[b][y + 8 * z]} >> 1)} << (8 * y);
      }
      if (Coder::kDecodes) state.solid[b][z] = slice;
    }
  }
  shared = coder;
}

// Bit x + 8 y of each slice: whether an empty voxel, or a voxel that the page does not hold, is around.
struct Around {
  std::array<std::uint64_t, 8> empty{}, unknown{};
};
inline Around findAround(const Window& window) {
  // Empty ones in the low 32 bits, unknown ones in the high ones.
  std::array<std::array<std::uint64_t, 10>, 10> rows;
  for (std::size_t z = 0; z < 10; ++z)
    for (std::size_t y = 0; y < 10; ++y) {
      const std::uint32_t row = window[z][y];
      const std::uint64_t both = (row & kEachVoxel) | std::uint64_t{~(row | row >> 1) & kEachVoxel} << 32;
      rows[z][y] = both | both << 2 | both >> 2;
    }
  for (auto& slice : rows)
    for (std::size_t y = 0; y < 8; ++y) slice[y] |= slice[y + 1] | slice[y + 2];
  Around around;
  for (std::size_t z = 0; z < 8; ++z)
    for (std::size_t y = 0; y < 8; ++y) {
      const std::uint64_t both = rows[z][y] | rows[z + 1][y] | rows[z + 2][y];
      around.empty[z] |= std::uint64_t{gatherRow(static_cast<std::uint32_t>(both >> 2))} << (8 * y);
      around.unknown[z] |= std::uint64_t{gatherRow(static_cast<std::uint32_t>(both >> 34))} << (8 * y);
    }
  return around;
}

// Which voxels of slice z the coarser level makes inner.
inline std::uint64_t innerByCoarse(const PageShape& shape, std::size_t brick, std::size_t z) {
  if (shape.above.empty()) return 0;
  const CoarseBlock& block = shape.above[brick];
  std::uint64_t inner = 0;
  for (std::size_t y = 0; y < 4; ++y) {
    const std::uint64_t row = gatherRow(spreadCoarse(coarseRow(block.solid & ~block.surface, y, z / 2)));
    inner |= (row | row << 8) << (16 * y);
  }
  return inner;
}

// Codes which solid voxels are surface. False: a brick has none.
template <class Coder>
bool codeSurface(Coder& shared, const PageShape& shape, PageState& state, bool exact) {
  Coder coder = shared;
  Window window;
  bool every = true;
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    lookAround(state, b, window);
    const Around around = findAround(window);
    std::uint64_t any = 0;
    std::array<std::uint64_t, 8> sure;
    for (std::size_t z = 0; z < 8; ++z) sure[z] = state.solid[b][z] & around.empty[z];
    for (std::size_t z = 0; z < 8; ++z) {
      const std::uint64_t inner = innerByCoarse(shape, b, z);
      std::uint64_t surface = sure[z] & ~inner;
      std::uint64_t open = state.solid[b][z] & ~around.empty[z] & ~inner;
      if (exact) open &= around.unknown[z];
      for (; open != 0; open &= open - 1) {
        const int at = std::countr_zero(open);
        const int x = at & 7, y = at >> 3;
        // Surface voxels at the six sides, as far as the brick knows them.
        std::size_t sides = 0;
        sides += x > 0 && (surface >> (at - 1) & 1);
        sides += x < 7 && (sure[z] >> (at + 1) & 1);
        sides += y > 0 && (surface >> (at - 8) & 1);
        sides += y < 7 && (sure[z] >> (at + 8) & 1);
        sides += z > 0 && (state.surface[b][z - 1] >> at & 1);
        sides += z < 7 && (sure[z + 1] >> at & 1);
        Bit& model = state.models.surface[around.unknown[z] >> at & 1][sides];
        const bool value = coder.bit(model, !Coder::kDecodes && (state.surface[b][z] >> at & 1));
        surface |= std::uint64_t{value} << at;
      }
      if (Coder::kDecodes) state.surface[b][z] = surface;
      any |= surface;
    }
    every = every && any != 0;
  }
  shared = coder;
  return every;
}

}  // namespace kelp::coding

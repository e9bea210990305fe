// SPDX-License-Identifier: MIT
// The state that encoder and decoder of a page of a solid level share: the models of SPEC.md, 5.3, and which
// voxels are known.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "page_codec.h"
#include "range_coder.h"

namespace kelp::coding {

// A row of voxels along x, two bits a voxel.
inline constexpr std::uint32_t kUnknown = 0, kEmpty = 1, kSolid = 2;

using BrickRows = std::array<std::uint16_t, 64>;  // of 8 voxels; row y + 8 z

inline constexpr BrickRows kUnknownRows{};
inline constexpr BrickRows kEmptyRows = [] {
  BrickRows rows{};
  rows.fill(0x5555);
  return rows;
}();

// Rows of the 10 x 10 x 10 voxels of a brick and around it: voxel x at bits 2 x + 2.
using Window = std::array<std::array<std::uint32_t, 10>, 10>;  // [z + 1][y + 1]

inline constexpr int kBins = 16;
inline constexpr std::uint16_t kNoAttribute = 0xffff;
inline constexpr int kClasses = 16;  // of sizes of differences: 0, 1, 2..3, 4..7, ... 2048..4095
inline constexpr int kRecent = 16;

// The numbers of a page's header.
struct PageHeader {
  std::uint32_t limit = 4;    // of Bit::shift
  bool exact = false;         // a voxel is surface exactly if an empty one is around it
  std::uint32_t dropped = 0;  // low bits of u and of v that are the same in all normals
  std::uint32_t pattern = 0;  // these bits, in their places
  std::size_t plain_bytes = 0;
};
inline constexpr std::size_t kHeaderBytes = 3, kPatternBytes = 3;
inline constexpr std::uint32_t kLeastLimit = 3;  // two bits
inline constexpr std::uint32_t kMostDropped = 11;
constexpr std::uint32_t droppedBits(std::uint32_t dropped) { return ((1u << dropped) - 1) * 0x1001; }

// How new the normals around are: none of them, at most a quarter, at most half, fewer than all, all.
inline constexpr std::size_t kNewness = 5;

// A tree of n values has the decisions 1 to n - 1: the first bit decides at 1, the next at 2 or 3, and so on.
struct Models {
  std::array<std::array<Bit, kBins>, 8> solid;  // [parity of x, y, z][bin]
  std::array<std::array<Bit, 7>, 2> surface;    // [whether a voxel around is unknown][surface sides]
  // The normal is the only one around, or the first of the ballot though not the nearest; the first, and the
  // nearest; the second.
  std::array<std::array<std::array<Bit, 16>, kNewness>, 3> same;
  std::array<Bit, kNewness + 1> known;  // it is one around or recent; the last is asked before the ballot
  std::array<Bit, 4> other;             // it is the next one of the ballot
  std::array<Bit, kRecent> recent;      // a tree: which of the recent ones
  std::array<std::array<std::array<std::array<Bit, kClasses>, kClasses>, kClasses / 2>, 2>
      size_of;  // [axis][half the class on the axis before][spread]: a tree
  std::array<std::array<Bit, 16>, 3> entry_same;
  std::array<Bit, 256> entry;  // a tree
};

struct PageState {
  Models models;
  std::array<BrickRows, kMaxPageBricks> rows;
  std::array<std::array<std::uint64_t, 8>, kMaxPageBricks> solid, surface;  // bit x + 8 y of slice z
  std::array<std::array<std::int16_t, 27>, kMaxPageBricks>
      around;  // bricks of the page, -1: none, -2: outside
  std::array<std::array<std::uint16_t, 512>, kMaxPageBricks> index;  // of the voxel's attribute
  std::array<std::uint8_t, kMaxPageAttributes> fresh;                // true: its normal was new
};

// The state in the workspace; null: no memory.
PageState* prepareState(const PageShape& shape, Buffer<std::byte>& workspace);

// True if the shape is one of a page.
bool isPageShape(const PageShape& shape);

}  // namespace kelp::coding

// SPDX-License-Identifier: MIT
// How voxels lie in memory at run time, on the CPU and on the GPU alike: 32-bit words that can be copied from one to the other as they are.
//
//   cell, one word a brick     empty: as in the pack (kelp/formats/brick.h)
//                              stored: kCellSolid | page << 7 | brick within the page
//   page, up to 128 bricks     brick b has the words kBrickWords * b on: 4 of slices, then 128 of codes, four to a word, the first lowest;
//                              after the bricks the attributes of all of them
//   page of fog            brick b has the words kFogChannelWords * channels * b on, channel after channel: density, heat
//   channel of fog         a word for each cube and for those of one more layer above: x + 8 (y + 8 z), z 0 .. 8. It has the samples at the lower z of the
//                          cube's corners, (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1), the first lowest: two words are all a cube has
//   slice, 16 bits each        of z-slices 0 .. 7, the lower one in the lower half of a word: where the attributes of its surface voxels
//                              begin, in words from the brick's own first word
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/brick.h"
#include "kelp/formats/pack.h"

namespace kelp::runtime {

inline constexpr std::uint32_t kSliceWords = 4;
inline constexpr std::uint32_t kBrickWords = kSliceWords + kBrickVoxels / 4;
inline constexpr std::uint32_t kMaxPageBricks = 128;
inline constexpr std::uint32_t kMaxPages = 1u << 17;  // of a level: what a cell has bits for

inline std::uint32_t makeStoredCell(std::uint32_t page, std::uint32_t brick) { return kCellSolid | page << 7 | brick; }
inline std::uint32_t cellPage(std::uint32_t cell) { return cell >> 7 & (kMaxPages - 1); }
inline std::uint32_t cellBrick(std::uint32_t cell) { return cell & (kMaxPageBricks - 1); }

inline constexpr std::uint32_t kFogChannelWords = kBrickSide * kBrickSide * (kBrickSide + 1);

// Words of a page, from its entry in the pack.
std::uint32_t pageWords(const PageInfo& page);
// Arranges a decoded page; `words` has pageWords() of them. False if codes and attributes contradict each other.
[[nodiscard]] bool arrangePage(const PageData& page, std::span<std::uint32_t> words);

// `brick` points to a brick's first word; the voxel is taken modulo 8.
inline std::uint8_t codeOf(const std::uint32_t* brick, const glm::ivec3& voxel) {
  const int i = codeIndex(voxel);
  return static_cast<std::uint8_t>(brick[kSliceWords + static_cast<std::uint32_t>(i >> 2)] >> (8 * (i & 3)));
}
// Of a surface voxel, with its code.
inline std::uint32_t attributeOf(const std::uint32_t* brick, const glm::ivec3& voxel, std::uint8_t code) {
  const int slice = voxel.z & 7;
  return brick[(brick[slice >> 1] >> (16 * (slice & 1)) & 0xffffu) + code - kSurfaceCode];
}

}  // namespace kelp::runtime

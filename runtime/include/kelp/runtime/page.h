// SPDX-License-Identifier: MIT
// How voxels lie in memory at run time, on the CPU and on the GPU alike: 32-bit words that can be copied from
// one to the other.
//
//   cell, one word a brick
//     empty        as in the pack (kelp/formats/brick.h)
//     stored       makeStoredCell (kelp/formats/brick.h)
//     inside       as brick 0 of one more page, which every level of voxels has after its own: kSolidBrick.
//                  So rays, queries and shading need not tell it from a stored one
//   page, up to 128 bricks
//     Brick b starts at word kBrickWords * b: 4 words of slices, then 128 words of codes, four a word, the
//     first in the lowest byte. After the bricks come the attributes of all of them.
//   slice, 16 bits for each z-slice 0 .. 7 of a brick, the lower z in the lower half of a word
//     The offset of the attributes of the slice's surface voxels, in words from the brick's first word.
//   page of fog
//     Brick b starts at word kFogChannelWords * channels * b, with one channel after the other: density,
//     heat.
//   channel of fog
//     One word for each cube, and for one more layer of cubes above: word x + 8 (y + 8 z), z 0 .. 8. Its
//     bytes are the samples at the lower z of the cube's corners (x, y), (x + 1, y), (x, y + 1), (x + 1, y +
//     1), the first in the lowest byte. So two words hold all samples of a cube.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/brick.h"
#include "kelp/formats/pack.h"

namespace kelp::runtime {

inline constexpr std::uint32_t kSliceWords = 4;
inline constexpr std::uint32_t kBrickWords = kSliceWords + kBrickVoxels / 4;
// The brick whose voxels are all inner.
inline constexpr auto kSolidBrick = [] {
  std::array<std::uint32_t, kBrickWords> words{};
  for (std::uint32_t i = kSliceWords; i < kBrickWords; ++i) words[i] = kInnerCode * 0x01010101u;
  return words;
}();

inline constexpr std::uint32_t kFogChannelWords = kBrickSide * kBrickSide * (kBrickSide + 1);

// Number of words of a page.
std::uint32_t pageWords(const PageInfo& page);
// Converts a decoded page. `words` must have pageWords() elements. False if codes and attributes do not
// match. Safe for hostile pages.
[[nodiscard]] bool arrangePage(const PageData& page, std::span<std::uint32_t> words);

// The code of a voxel. brick: the brick's first word. The voxel's coordinates are taken modulo 8.
inline std::uint8_t codeOf(const std::uint32_t* brick, const glm::ivec3& voxel) {
  const int i = codeIndex(voxel);
  return static_cast<std::uint8_t>(brick[kSliceWords + static_cast<std::uint32_t>(i >> 2)] >> (8 * (i & 3)));
}
// The attribute of a surface voxel, whose code is given.
inline std::uint32_t attributeOf(const std::uint32_t* brick, const glm::ivec3& voxel, std::uint8_t code) {
  const int slice = voxel.z & 7;
  return brick[(brick[slice >> 1] >> (16 * (slice & 1)) & 0xffffu) + code - kSurfaceCode];
}

}  // namespace kelp::runtime

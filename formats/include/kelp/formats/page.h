// SPDX-License-Identifier: MIT
// Pages in memory: 32-bit words, the same on the CPU and on the GPU, where a renderer copies them to.
//
//   cell, one word a brick, of a level that was read
//     empty        As in kelp/formats/brick.h; of distances kFarOutside or kFarInside, the code of all of the
//                  brick's voxels (kelp/formats/distance.h).
//     stored       makeStoredCell(page, brick): the page of the brick and its place there.
//     inside       makeStoredCell(number of pages, 0): as brick 0 of one more page, kSolidBrick. So rays,
//                  queries and shading need not tell it from a stored one. Of voxels only.
//   page of voxels, up to 128 bricks
//     Brick b starts at word kBrickWords * b: 4 words of slices, then 128 words of codes, four a word, the
//     first in the lowest byte. After the bricks come the attributes of all of them.
//   slice, 16 bits for each z-slice 0 .. 7 of a brick, the lower z in the lower half of a word
//     The offset of the attributes of the slice's surface voxels, in words from the brick's first word.
//   page of distances
//     Brick b starts at word kCodeWords * b: 128 words of codes.
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
#include "kelp/formats/buffer.h"

namespace kelp {

// One page of bricks in the file. A page of voxels needs the shapes of the coarser voxels over it and beside
// it, all others can be loaded by themselves.
struct PageInfo {
  static constexpr std::uint8_t kDistances = 3;

  std::uint64_t offset = 0;  // in the file
  std::uint32_t stored = 0;  // bytes in the file
  std::uint32_t raw = 0;     // decoded bytes, at most 64 KiB
  std::uint64_t checksum = 0;
  std::uint32_t first_slot = 0;
  std::uint32_t count = 0;    // bricks
  std::uint8_t channels = 0;  // 0: voxels; 1: density of fog; 2: density and heat; kDistances
};

inline constexpr std::uint32_t kSliceWords = 4;
inline constexpr std::uint32_t kCodeWords = kBrickVoxels / 4;
inline constexpr std::uint32_t kBrickWords = kSliceWords + kCodeWords;
inline constexpr std::uint32_t kFogChannelWords = kBrickSide * kBrickSide * (kBrickSide + 1);
// The brick whose voxels are all inner.
inline constexpr auto kSolidBrick = [] {
  std::array<std::uint32_t, kBrickWords> words{};
  for (std::uint32_t i = kSliceWords; i < kBrickWords; ++i) words[i] = kInnerCode * 0x01010101u;
  return words;
}();

// Number of words of a page.
std::uint32_t pageWords(const PageInfo& page);

// The code of a voxel. brick: the first word of a brick of voxels. The voxel's coordinates are taken modulo
// 8.
inline std::uint8_t codeOf(const std::uint32_t* brick, const glm::ivec3& voxel) {
  const int i = codeIndex(voxel);
  return static_cast<std::uint8_t>(brick[kSliceWords + static_cast<std::uint32_t>(i >> 2)] >> (8 * (i & 3)));
}
// The attribute of a surface voxel, whose code is given.
inline std::uint32_t attributeOf(const std::uint32_t* brick, const glm::ivec3& voxel, std::uint8_t code) {
  const int slice = voxel.z & 7;
  return brick[(brick[slice >> 1] >> (16 * (slice & 1)) & 0xffffu) + code - kSurfaceCode];
}

// One decoded page, and the memory that decoding takes. Keep one per thread and reuse it: once it has held
// the largest page, it allocates no more.
struct PageData {
  PageData() = default;
  explicit PageData(const Allocator& allocator)
      : words(allocator), shapes(allocator), fog(allocator), scratch(allocator), workspace(allocator) {}

  PageInfo info;
  Buffer<std::uint32_t> words;  // unless they were decoded to another place
  Buffer<BrickShape> shapes;    // of voxels, one a brick
  // Of fog: 729 densities a brick, then 729 heats a brick (kelp/formats/fog.h).
  Buffer<std::uint8_t> fog;
  Buffer<std::byte> scratch, workspace;  // used by the reader only

  // Of voxels and distances: the 512 codes of a brick.
  std::span<const std::uint8_t> codes(std::size_t brick) const {
    const bool slices = info.channels != PageInfo::kDistances;
    const std::uint32_t* const first = words.data() + brick * (slices ? kBrickWords : kCodeWords);
    return {reinterpret_cast<const std::uint8_t*>(first + (slices ? kSliceWords : 0)), kBrickVoxels};
  }
  // Of voxels: one a surface voxel, brick by brick, in the order of codes.
  std::span<const std::uint32_t> attributes() const {
    return info.channels == 0 ? words.span().subspan(std::size_t{info.count} * kBrickWords)
                              : std::span<const std::uint32_t>();
  }
};

}  // namespace kelp

// SPDX-License-Identifier: MIT
// How voxels lie in memory: bricks of 8 x 8 x 8 one-byte codes, a grid of cells over them, and one attribute
// for each surface voxel. formats/SPEC.md, section 5, says what they mean and how a file holds them.
//
//   cell (u32), one a brick
//     bit 31 = 0     The brick is empty. Six numbers of 4 bits say how many bricks its empty box reaches
//                    beyond it: bits 0..3 towards -x, 4..7 +x, 8..11 -y, 12..15 +y, 16..19 -z, 20..23 +z.
//                    Bits 24..30: its clearance in voxels, rounded down, at most 127.
//     bit 31 = 1     The brick is stored: it holds a surface voxel. Bits 0..23: its slot. Bits 24..30: zero.
//     kCellInside    All voxels of the brick are inner. It is not stored.
//   code (u8), one a voxel
//     0 ..  63       Empty. Its empty box reaches 2^k - 1 voxels on both sides of it, with k = bits 0,1
//                    along x, bits 2,3 along y, bits 4,5 along z.
//     64 .. 127      Surface voxel: solid, with an attribute. code - 64 = its rank among the surface voxels
//                    of its z-slice.
//     128            Inner voxel: solid, without an attribute.
//   attribute (u32), one a surface voxel
//                    Bits 0..7: palette index. Bits 8..19 and 20..31: octahedral normal, u and v.
//
// The boxes of cells and codes are not in the file: the reader makes them (kelp/formats/empty_boxes.h). Nor
// are slots, which ascend in Morton order. While a level is written, a stored cell holds its slot; once it is
// read, the page of its brick and its place there (kelp/formats/page.h).
//
// Clearance: the exact Euclidean distance between the brick's closed 8 x 8 x 8 cube and the closed cube of
// the nearest solid voxel, in voxels of the level. Boxes may reach beyond the volume, where nothing is solid.
// Surface voxels of level 0 are the solid voxels with an empty voxel, or the outside of the volume, among
// their 26 neighbors. At coarser levels they are the voxels above a surface voxel.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "kelp/formats/error.h"

namespace kelp {

inline constexpr int kBrickSide = 8;
inline constexpr int kBrickVoxels = 512;
inline constexpr std::uint8_t kSurfaceCode = 64;
inline constexpr std::uint8_t kInnerCode = 128;
inline constexpr std::uint32_t kCellSolid = 0x80000000u;
inline constexpr std::uint32_t kCellInside = 0xc0000000u;
inline constexpr std::uint32_t kCellSlotMask = 0x00ffffffu;
inline constexpr int kCellMaxReach = 15;
inline constexpr int kCellClearanceShift = 24;
inline constexpr std::uint32_t kCellMaxClearance = 127;
inline constexpr int kMaxLevels = 16;

// True if the cell's brick is stored, and not only solid.
inline bool isStoredCell(std::uint32_t cell) { return cell >> 30 == 2; }

inline bool isSolidCode(std::uint8_t code) { return code >= kSurfaceCode; }
inline bool isSurfaceCode(std::uint8_t code) { return code >= kSurfaceCode && code < kInnerCode; }

// How many voxels the box of an empty voxel reaches beyond it along each axis, on both sides. The code must
// be below kSurfaceCode.
inline glm::ivec3 codeReach(std::uint8_t code) {
  return {(1 << (code & 3)) - 1, (1 << (code >> 2 & 3)) - 1, (1 << (code >> 4)) - 1};
}
// How many bricks the box of an empty brick reaches beyond it. side: 0..5 = -x, +x, -y, +y, -z, +z.
inline int cellReach(std::uint32_t cell, int side) { return static_cast<int>(cell >> (4 * side) & 15u); }
// Clearance of an empty brick, in voxels.
inline int cellClearance(std::uint32_t cell) {
  return static_cast<int>(cell >> kCellClearanceShift & kCellMaxClearance);
}

// Cells of a level that was read. page: its index; the number of pages for a brick that is inside.
inline constexpr std::uint32_t kMaxPageBricks = 128;
inline constexpr std::uint32_t kMaxPages = 1u << 17;
inline constexpr std::uint32_t makeStoredCell(std::uint32_t page, std::uint32_t brick) {
  return kCellSolid | page << 7 | brick;
}
inline constexpr std::uint32_t cellPage(std::uint32_t cell) { return cell >> 7 & (kMaxPages - 1); }
inline constexpr std::uint32_t cellBrick(std::uint32_t cell) { return cell & (kMaxPageBricks - 1); }

// Bits of the voxels of a brick, slice by slice along z: bit x + 8 y of slices[z] is that of voxel (x, y, z).
struct BrickBits {
  std::uint64_t slices[8] = {};
};
inline constexpr BrickBits kEmptyBits{};

// Which voxels of a brick are solid, and which of these are surface.
struct BrickShape {
  BrickBits solid, surface;
};

// Size in voxels of level `level` of a volume of `size` level-0 voxels: ceil(size / 2^level), at least 1.
glm::ivec3 levelSize(const glm::ivec3& size, int level);
// Number of bricks along each axis of a level of `size` voxels: ceil(size / 8).
glm::ivec3 brickGrid(const glm::ivec3& size);
// Index of a voxel in the codes of its brick: x + 8 (y + 8 z), with each coordinate modulo 8.
inline int codeIndex(const glm::ivec3& voxel) {
  return (voxel.x & 7) | ((voxel.y & 7) << 3) | ((voxel.z & 7) << 6);
}
// Morton code of a brick's grid position, x in the lowest bit. Slots of a level ascend in this order.
std::uint64_t mortonCode(const glm::ivec3& brick);

// A unit normal as 24 bits: octahedral around +y, with u (for x) in bits 0..11 and v (for z) in bits 12..23.
// Every value of the 24 bits can be decoded:
//   x = (min(u, 4094) - 2047) / 2047, z likewise from v, y = 1 - |x| - |z|, f = max(-y, 0),
//   x -= x >= 0 ? f : -f, z -= z >= 0 ? f : -f, then (x, y, z) is normalized.
// encodeNormal returns the nearest representable normal whose low `ones` bits of u and of v are all ones;
// pages of such normals are smaller. ones: 0 to 8. A zero or non-finite input gives +y, or what is nearest to
// it.
std::uint32_t encodeNormal(const glm::vec3& normal, int ones = 0);
glm::vec3 decodeNormal(std::uint32_t bits24);

inline std::uint32_t makeAttribute(std::uint8_t palette_index, std::uint32_t normal24) {
  return palette_index | (normal24 << 8);
}
inline std::uint8_t attributePalette(std::uint32_t attribute) {
  return static_cast<std::uint8_t>(attribute & 0xffu);
}
inline std::uint32_t attributeNormal(std::uint32_t attribute) { return attribute >> 8; }

// Writes the index of the first attribute of each z-slice of each brick, 8 values a brick, starting at
// `first`. Returns the number of attributes. kMisuse unless `codes` holds whole bricks and `slice_base` has
// room for 8 values a brick; kCorrupt if a code is reserved or a rank is wrong. Safe for hostile codes.
Result<std::uint32_t> computeSliceBase(std::span<const std::uint8_t> codes, std::uint32_t first,
                                       std::span<std::uint32_t> slice_base);

}  // namespace kelp

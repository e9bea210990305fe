// SPDX-License-Identifier: MIT
// How voxels are stored: 8 x 8 x 8 bricks of one-byte codes, a grid of cells over them, one attribute for each surface voxel.
// formats/SPEC.md is the law; this header is its voxel section in C++.
//
//   grid cell (u32)      bit 31 = 0: the brick is empty. A box of empty bricks reaches bits 0..3 bricks beyond it towards -x, 4..7 towards +x,
//                          8..11 -y, 12..15 +y, 16..19 -z, 20..23 +z; bits 24..30 = its clearance in voxels, rounded down, at most 127
//                        bit 31 = 1: the brick holds at least one solid voxel; bits 0..23 = its slot (bits 24..30 zero)
//   code (u8)            0 ..  63   empty voxel. A box of empty voxels reaches 2^k - 1 voxels beyond it on both sides, k = bits 0,1 along x,
//                                    2,3 along y, 4,5 along z
//                        64 .. 127   surface voxel (solid, has an attribute); code - 64 = its rank among the surface voxels of its z-slice (files hold 64)
//                        128         inner voxel (solid, no attribute)
//   attribute (u32)      bits 0..7 palette index, bits 8..19 and 20..31 octahedral normal (u, v; 12 bits each)
//
// Clearance = exact Euclidean distance between the closed 8^3 cube of the brick and the nearest solid voxel's closed cube, in voxels of its
// level. Boxes may reach beyond the volume: nothing is solid there. Surface voxels are the solid voxels that have an empty voxel (or the
// outside of the volume) among their 26 neighbours at level 0; above, those above a surface voxel.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace kelp {

inline constexpr int kBrickSide = 8;
inline constexpr int kBrickVoxels = 512;
inline constexpr std::uint8_t kSurfaceCode = 64;
inline constexpr std::uint8_t kInnerCode = 128;
inline constexpr std::uint32_t kCellSolid = 0x80000000u;
inline constexpr std::uint32_t kCellSlotMask = 0x00ffffffu;
inline constexpr int kCellMaxReach = 15;
inline constexpr int kCellClearanceShift = 24;
inline constexpr std::uint32_t kCellMaxClearance = 127;
inline constexpr int kMaxLevels = 16;

inline bool isSolidCode(std::uint8_t code) { return code >= kSurfaceCode; }
inline bool isSurfaceCode(std::uint8_t code) { return code >= kSurfaceCode && code < kInnerCode; }

// How far beyond an empty voxel its box reaches along each axis, both ways; voxels. The code must be below kSurfaceCode.
inline glm::ivec3 codeReach(std::uint8_t code) { return {(1 << (code & 3)) - 1, (1 << (code >> 2 & 3)) - 1, (1 << (code >> 4)) - 1}; }
// How far beyond an empty brick its box reaches on side 0..5 = -x, +x, -y, +y, -z, +z; bricks.
inline int cellReach(std::uint32_t cell, int side) { return static_cast<int>(cell >> (4 * side) & 15u); }
// Clearance of an empty brick; voxels.
inline int cellClearance(std::uint32_t cell) { return static_cast<int>(cell >> kCellClearanceShift & kCellMaxClearance); }

// Voxels of level `level` of a volume of `size` voxels: ceil(size / 2^level), at least 1.
glm::ivec3 levelSize(const glm::ivec3& size, int level);
// Bricks over `size` voxels: ceil(size / 8).
glm::ivec3 brickGrid(const glm::ivec3& size);
// Position of a voxel in its brick's codes: x + 8 (y + 8 z), all modulo 8.
inline int codeIndex(const glm::ivec3& voxel) { return (voxel.x & 7) | ((voxel.y & 7) << 3) | ((voxel.z & 7) << 6); }
// Morton order of bricks (x lowest bit), the order of slots in a level.
std::uint64_t mortonCode(const glm::ivec3& brick);

// Unit normal <-> 24 bits: octahedral around +y, u in bits 0..11 for x, v in bits 12..23 for z. Every value of the 24 bits decodes:
//   x = (min(u, 4094) - 2047) / 2047, z likewise from v, y = 1 - |x| - |z|, f = max(-y, 0),
//   x -= x >= 0 ? f : -f, z -= z >= 0 ? f : -f, then normalise (x, y, z).
// encode picks the nearest of the representable normals; a zero or non-finite input gives +y.
std::uint32_t encodeNormal(const glm::vec3& normal);
glm::vec3 decodeNormal(std::uint32_t bits24);

inline std::uint32_t makeAttribute(std::uint8_t palette_index, std::uint32_t normal24) { return palette_index | (normal24 << 8); }
inline std::uint8_t attributePalette(std::uint32_t attribute) { return static_cast<std::uint8_t>(attribute & 0xffu); }
inline std::uint32_t attributeNormal(std::uint32_t attribute) { return attribute >> 8; }

// Index of the first attribute of each z-slice of each brick: 8 values a brick, counted on from `first`. `codes` holds whole bricks;
// slice_base must hold 8 values for each of them. Answers the number of attributes, or -1 when a code is reserved or a rank is not the
// one it should be. Safe for hostile codes.
std::int64_t computeSliceBase(std::span<const std::uint8_t> codes, std::uint32_t first, std::span<std::uint32_t> slice_base);

}  // namespace kelp

// SPDX-License-Identifier: MIT
// Cages of solid parts (kelp/formats/cage.h) from their voxels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "kelp/fields/solid_bits.h"
#include "kelp/formats/raw_pack.h"

namespace kelp::fields {

// Sides of the finest cells: these, and the powers of two between.
inline constexpr int kSmallestCell = 2, kLargestCell = 16;

// A bit of a voxel's cuts: it does not touch the neighbor at this offset, which is (0, 0, 1), or (x, y, 1),
// or (x, 1, 0), or (1, 0, 0): one that comes later.
constexpr std::uint16_t cutBit(const glm::ivec3& offset) {
  return static_cast<std::uint16_t>(1 << (offset.x + 3 * offset.y + 9 * offset.z - 1));
}

// The cages of a part with so many levels, one for each, finest first. solid: its level 0. cell: the side of
// the finest cells, in voxels. cuts: of each voxel, dense, x fastest,
// then y, then z; or none: see cutBit().
//
// Pieces of a cube of the finest cage are its solid voxels that touch, in the order of their first voxels; to
// touch is to be among the 26 neighbors, and not cut apart. Pieces of a coarser cube are the finer cells in
// it that touch, in the order of their first finer cells, by cubes (x fastest, then y, then z), then pieces:
// so voxels that touch are one piece there too. Cells of two cubes that touch have the corners in common that
// their cubes share. What is beyond 254 pieces of a cube, or beyond 256 nodes of a point, joins the last.
//
// A node of a coarser cage follows the nearest of the finer cells that lie in its cells, and the one with the
// least number of several. If all of these are inside, it follows the nearest cell of all.
//
// Throws std::invalid_argument if nothing is solid, if formats know no such cell for the size, or if there
// are not as many cuts as voxels.
std::vector<RawCage> buildCages(const SolidBits& solid, int levels, int cell,
                                std::span<const std::uint16_t> cuts = {});
// The same from the level 0 of a pack.
std::vector<RawCage> buildCages(const RawLevel& level, const glm::ivec3& size, int levels, int cell);

}  // namespace kelp::fields

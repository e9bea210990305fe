// SPDX-License-Identifier: MIT
// The bricks above those of a page and beside them, which decoding them needs besides their bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kelp/formats/level.h"
#include "page_codec.h"

namespace kelp {

// The bricks of one page of a level of voxels, and the coarser voxels over them.
struct PageFrame {
  std::array<glm::ivec3, kMaxPageBricks> bricks;
  std::array<CoarseBlock, kMaxPageBricks> above;
  PageShape shape;  // of these two

  // kMisuse: a coarser brick over the page has no known shape. kCorrupt: one is not stored. palette: entries.
  Result<void> make(const LevelGrid& grid, std::size_t page, const LevelAbove& over, std::size_t palette);
};

// The 4 x 4 x 4 voxels over one of the eight bricks below a coarser one. brick: the finer one's place.
CoarseBlock blockOver(const BrickShape& coarse, const glm::ivec3& brick);

// Writes the bricks of a page of voxels, slices and codes, to their places in the page's words. Their boxes
// hold nothing that may be solid: voxels of other pages are as solid as the coarser ones over them. shapes:
// of the bricks.
void writeBricks(const LevelGrid& grid, std::size_t page, const LevelAbove& over,
                 std::span<const BrickShape> shapes, std::span<std::uint32_t> words);

// The shapes of bricks with these codes, 512 a brick.
void shapesOf(std::span<const std::uint8_t> codes, std::span<BrickShape> shapes);

}  // namespace kelp

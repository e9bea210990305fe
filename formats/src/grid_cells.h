// SPDX-License-Identifier: MIT
// Cells as the file has them, a byte each: SPEC.md, 5.2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/pack.h"
#include "voxels.h"

namespace kelp {

// Writes the bytes of a level's cells (kelp/formats/raw_pack.h). bytes: one a cell.
void storeCells(std::span<const std::uint32_t> cells, const glm::ivec3& grid, std::span<std::byte> bytes);

// How many of the bricks are stored, at least 1. The offset of an error is the index of the byte.
Result<std::uint32_t> countStored(std::span<const std::byte> bytes);

// Fills out.cells and out.bricks, which have their size, with what the bytes say. out.size, out.grid and
// out.pages are known. Boxes are left 0. The offset of an error is the index of the byte.
Result<void> loadCells(std::span<const std::byte> bytes, int channels, LevelGrid& out);

}  // namespace kelp

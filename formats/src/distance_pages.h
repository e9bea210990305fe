// SPDX-License-Identifier: MIT
// The rules of SPEC.md for distances, for reader, writer and verifier.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/pack.h"

namespace kelp {

// A level of distances without its codes.
struct DistanceLevel {
  glm::ivec3 size{0};
  glm::ivec3 grid{0};
  DistanceBand band;
  std::span<const std::uint32_t> cells, bricks;  // as in DistanceGrid
};
inline DistanceLevel levelOf(const DistanceGrid& grid) {
  return {grid.size, grid.grid, grid.band, grid.cells.span(), grid.bricks.span()};
}
inline glm::ivec3 brickAt(const DistanceLevel& level, std::size_t slot) {
  const auto x = static_cast<std::uint32_t>(level.grid.x), y = static_cast<std::uint32_t>(level.grid.y);
  return glm::ivec3(level.bricks[slot] % x, level.bricks[slot] / x % y, level.bricks[slot] / x / y);
}

// Checks cells: what they may hold, and slots that ascend from 0 in Morton order. Returns the number of
// stored bricks, at least 1. The offset of an error is the index of the cell.
Result<std::uint32_t> checkDistanceCells(std::span<const std::uint32_t> cells, const glm::ivec3& grid);
// Fills the index of the cell of each slot.
void listBricks(std::span<const std::uint32_t> cells, const glm::ivec3& grid,
                std::span<std::uint32_t> bricks);
bool isPossibleBand(DistanceBand band);

// Reads, checks and decodes a DGRD chunk of a level whose DIST chunk is `pages`. The offset of an error is
// that in the file.
Result<DistanceGrid> readDistanceLevel(const Source& source, const Pack::ChunkInfo& chunk,
                                       const Pack::ChunkInfo& pages, const glm::ivec3& size,
                                       const Limits& limits, const Allocator& allocator);

// Writes the header and the cells of a DGRD chunk.
void storeDistanceCells(const DistanceLevel& level, std::span<std::byte> chunk);

// The codes of a brick that follow from the bits of its page alone: no distance can be greater. bits: of the
// page's bricks. brick: which of them.
void predictDistances(const DistanceLevel& level, std::uint32_t first_slot, std::span<const BrickBits> bits,
                      std::size_t brick, std::span<std::uint8_t, kBrickVoxels> codes);

// The rule that the brick breaks, or null. codes: its 512; predicted: predictDistances' answer for it.
const char* findDistanceFault(const DistanceLevel& level, const glm::ivec3& brick,
                              std::span<const std::uint8_t> codes, std::span<const std::uint8_t> predicted);

// Reads a page, checks its checksum, decodes it and checks what its own bits tell. The offset of an error is
// the page's.
Result<void> decodeDistancePage(const Source& source, const DistanceLevel& level, const PageInfo& page,
                                DistancePage& out);

}  // namespace kelp

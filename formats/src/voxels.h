// SPDX-License-Identifier: MIT
// Grids and pages: the rules of SPEC.md about voxels, used by reader, writer and verifier alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/pack.h"

namespace kelp {

// Checks the cells of a grid: reserved bits, and slots that count up from 0 in Morton order. Answers the number of stored bricks,
// at least one. The offset of the error is the cell's index.
Result<std::uint32_t> checkCells(std::span<const std::uint32_t> cells, const glm::ivec3& grid);

// Number of cells of a grid.
std::uint64_t cellCount(const glm::ivec3& grid);

// What a level's grid is divided by: its voxels or, of fog, its cubes; and the channels of its pages.
struct Lattice {
  glm::ivec3 size{0};
  int channels = 0;  // see PageInfo
};
Lattice latticeOf(const Part& part, int level);

// Reads a decoded GRID chunk of a level whose BRCK or FOGB chunk is `bricks`. The offset of errors counts from the chunk's begin.
Result<void> parseGrid(std::span<const std::byte> chunk, const Lattice& lattice, const Pack::ChunkInfo& bricks, LevelGrid& out);

// Reads, checks and decodes the grid of a level. The offset of errors is that in the file.
Result<LevelGrid> readLevelGrid(const Source& source, const Pack::ChunkInfo& chunk, const Pack::ChunkInfo& bricks,
                                const Lattice& lattice, const Limits& limits, const Allocator& allocator);

// Whether the page's numbers are possible at all; memory for it is then bounded.
bool isPossiblePage(const PageInfo& page);

// Turns codes as a page holds them, whole bricks with 64 for each surface voxel, into codes with ranks (brick.h). Answers the number of surface voxels,
// or -1 when a code is reserved.
std::int64_t giveRanks(std::span<std::uint8_t> codes);

// Reads a page, checks its checksum and decodes it: sizes and, of solids, codes and ranks are then right. The offset of errors is the page's.
Result<void> decodePage(const Source& source, const PageInfo& page, PageData& out);

// Bytes of a fog brick's samples in one channel, of a page's whole channel.
std::span<const std::uint8_t> fogChannel(const PageData& page, int channel);
// Index of the first brick of fog whose cubes are all clear, or -1. `channels` as in PageData::fog.
std::int64_t findClearBrick(std::span<const std::uint8_t> fog, int channels);
// Whether a brick of fog has a sample that is not 0 outside a level of `samples`. brick: its place in the grid; channel: its 729 samples.
bool hasFogOutside(std::span<const std::uint8_t> channel, const glm::ivec3& brick, const glm::ivec3& samples);

// Index of the first brick without a solid voxel, or -1.
std::int64_t findBrickWithoutSolid(std::span<const std::uint8_t> codes);
// Index of the first attribute whose palette index is not below `palette_size`, or -1.
std::int64_t findWrongPaletteIndex(std::span<const std::uint32_t> attributes, std::size_t palette_size);
// Whether a brick holds a solid voxel outside a level of `size` voxels. codes: the brick's 512; brick: its place in the grid.
bool hasSolidOutside(std::span<const std::uint8_t> codes, const glm::ivec3& brick, const glm::ivec3& size);

}  // namespace kelp

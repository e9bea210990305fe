// SPDX-License-Identifier: MIT
// The rules of SPEC.md for grids and pages, for reader, writer and verifier.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/level.h"

namespace kelp {

// The space that a level's grid divides (voxels of a solid part, cubes of fog) and the channels of its pages.
struct Lattice {
  glm::ivec3 size{0};
  int channels = 0;  // see PageInfo

  bool distances() const { return channels == PageInfo::kDistances; }
};
Lattice latticeOf(const Part& part, int level);
Lattice distanceLattice(const Part& part, int level);

// Checks the cells of a grid: reserved bits, slots that ascend from 0 in Morton order, bricks that are inside
// and reach beyond the level. Returns the number of stored bricks, at least 1. The offset of an error is the
// index of the cell.
Result<std::uint32_t> checkCells(std::span<const std::uint32_t> cells, const Lattice& lattice);

// Number of cells of a grid.
std::uint64_t cellCount(const glm::ivec3& grid);

// Cells as the file has them, a byte each: SPEC.md, 5.2.
// Writes the bytes of a level's cells (kelp/formats/raw_pack.h). bytes: one a cell.
void storeCells(std::span<const std::uint32_t> cells, const Lattice& lattice, std::span<std::byte> bytes);

// How many of the bricks are stored, at least 1. The offset of an error is the index of the byte.
Result<std::uint32_t> countStored(std::span<const std::byte> bytes, const Lattice& lattice);

// Fills out.cells and out.bricks, which have their size, with what the bytes say. out.size, out.grid and
// out.pages are known. Boxes are left 0. The offset of an error is the index of the byte.
Result<void> loadCells(std::span<const std::byte> bytes, const Lattice& lattice, LevelGrid& out);

// Reads a decoded GRID or DGRD chunk of a level whose pages are in the chunk `bricks`. The offset of an error
// counts from the start of the chunk.
Result<void> parseGrid(std::span<const std::byte> chunk, const Lattice& lattice,
                       const Pack::ChunkInfo& bricks, LevelGrid& out);

// Reads the table of pages at the end of a decoded grid, from `table_at` on; whole entries. stored: the chunk
// that holds the pages. bricks: how many they hold. channels: see PageInfo. The offset of an error counts
// from the start of the chunk.
Result<void> parsePages(std::span<const std::byte> chunk, std::uint64_t table_at,
                        const Pack::ChunkInfo& stored, std::uint32_t bricks, int channels,
                        Buffer<PageInfo>& out);

// Reads, checks and decodes the grid of a level. The offset of an error is that in the file.
Result<LevelGrid> readLevelGrid(const Source& source, const Pack::ChunkInfo& chunk,
                                const Pack::ChunkInfo& bricks, const Lattice& lattice,
                                const PackLimits& limits, const Allocator& allocator);

// True if the page's numbers are possible; then its memory is bounded.
bool isPossiblePage(const PageInfo& page);

// Reads a page of fog into out.fog, checks its checksum and decodes it. Its size is then right. The offset of
// an error is the page's, here and below.
Result<void> decodeFogPage(const Source& source, const PageInfo& page, PageData& out);
// Reads a page of voxels, checks its checksum and decodes it into its words. They are then right, and so are
// its shapes. above: is not looked at if the level is the coarsest. palette: entries.
Result<void> decodeSolidPage(const Source& source, const LevelGrid& grid, std::size_t index,
                             const LevelAbove& above, std::size_t palette, std::span<std::uint32_t> words,
                             PageData& out);
// The same for distances. They are then as right as the page alone can tell.
Result<void> decodeDistancePage(const Source& source, const LevelGrid& grid, std::size_t index,
                                std::span<std::uint32_t> words, PageData& out);

// Reads the bytes of a page and compares them with its checksum.
Result<void> readStored(const Source& source, const PageInfo& page, std::span<std::byte> stored);

// Writes the words of a page of fog.
void writeFog(const PageInfo& page, std::span<const std::uint8_t> samples, std::span<std::uint32_t> words);

// The samples of one channel of all bricks of a page of fog.
std::span<const std::uint8_t> fogChannel(const PageData& page, int channel);
// Index of the first brick of fog that is clear, or -1. channels: as in PageData::fog.
std::int64_t findClearBrick(std::span<const std::uint8_t> fog, int channels);
// True if a brick of fog has a sample that is not 0 outside a level of `samples`. brick: its place in the
// grid. channel: its 729 samples.
bool hasFogOutside(std::span<const std::uint8_t> channel, const glm::ivec3& brick, const glm::ivec3& samples);

// Index of the first brick without a surface voxel, or -1.
std::int64_t findBrickWithoutSurface(std::span<const std::uint8_t> codes);
// Index of the first attribute whose palette index is not below `palette_size`, or -1.
std::int64_t findWrongPaletteIndex(std::span<const std::uint32_t> attributes, std::size_t palette_size);
// True if a brick has a solid voxel outside a level of `size` voxels. codes: its 512 codes. brick: its place
// in the grid.
bool hasSolidOutside(std::span<const std::uint8_t> codes, const glm::ivec3& brick, const glm::ivec3& size);

}  // namespace kelp

// SPDX-License-Identifier: MIT
#include "voxels.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "coding_libraries.h"
#include "container.h"
#include "distance_pages.h"
#include "kelp/formats/empty_boxes.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/level.h"
#include "layout.h"
#include "morton_walk.h"
#include "page_codec.h"
#include "page_frame.h"

namespace kelp {
namespace {

// Bytes that a cell of a grid takes while it is read: the cell, its brick's place, the sums for its box (more
// in flat grids), its byte in the file.
constexpr std::uint64_t kCellMemory = 16;
static_assert(kMaxPageBricks == layout::kMaxPageRaw / kBrickVoxels);

}  // namespace

std::uint64_t cellCount(const glm::ivec3& grid) {
  return static_cast<std::uint64_t>(grid.x) * static_cast<std::uint64_t>(grid.y) *
         static_cast<std::uint64_t>(grid.z);
}

Result<std::uint32_t> checkCells(std::span<const std::uint32_t> cells, const Lattice& lattice) {
  const glm::ivec3 whole = lattice.channels == 0 ? lattice.size / kBrickSide : glm::ivec3(0);
  std::uint32_t next = 0;
  for (MortonWalk walk(brickGrid(lattice.size)); !walk.done(); walk.next()) {
    const std::uint32_t cell = cells[static_cast<std::size_t>(walk.index())];
    if (lattice.distances() ? cell == kFarOutside || cell == kFarInside : !(cell & kCellSolid)) continue;
    if (cell == kCellInside) {
      const glm::ivec3& at = walk.cell();
      if (at.x < whole.x && at.y < whole.y && at.z < whole.z) continue;
      return Error{ErrorCode::kCorrupt, "a brick that is wholly inside reaches beyond the level, or is fog",
                   walk.index()};
    }
    if (next > kCellSlotMask)
      return Error{ErrorCode::kCorrupt, "a level has more than 2^24 bricks", walk.index()};
    if (cell != (kCellSolid | next))
      return Error{ErrorCode::kCorrupt, "a cell's slot is not the next in Morton order", walk.index()};
    ++next;
  }
  if (next == 0) return Error{ErrorCode::kCorrupt, "a level has no brick", 0};
  return next;
}

Lattice latticeOf(const Part& part, int level) {
  return {latticeSize(part.kind, levelSize(part.size, level)), part.fog ? part.fog->channels() : 0};
}
Lattice distanceLattice(const Part& part, int level) {
  return {levelSize(part.size, level), PageInfo::kDistances};
}

namespace {

// Where the cells of a grid's chunk begin, and its table of pages.
struct GridPlaces {
  explicit GridPlaces(const Lattice& lattice)
      : cells_at(lattice.distances() ? layout::kDgrdHeader : 0),
        cells(cellCount(brickGrid(lattice.size))),
        table_at(layout::align(cells_at + cells, 8)) {}
  std::uint64_t cells_at, cells, table_at;
};

}  // namespace

Result<void> parseGrid(std::span<const std::byte> chunk, const Lattice& lattice,
                       const Pack::ChunkInfo& bricks, LevelGrid& out) {
  out.size = lattice.size;
  out.grid = brickGrid(lattice.size);
  const GridPlaces at(lattice);
  if (chunk.size() < at.table_at || (chunk.size() - at.table_at) % layout::kPageEntryBytes != 0)
    return Error{ErrorCode::kCorrupt, "a grid's size does not match the part's size", 0};
  if (lattice.distances()) {
    out.band = {layout::load<std::uint8_t>(chunk, 0), layout::load<std::uint8_t>(chunk, 1)};
    if (!isPossibleBand(out.band))
      return Error{ErrorCode::kCorrupt, "a band of distances is not 16 to 225 outside and 4 to 28 inside", 0};
  }
  const auto isZero = [&](std::uint64_t from, std::uint64_t to) {
    return std::all_of(chunk.begin() + static_cast<std::ptrdiff_t>(from),
                       chunk.begin() + static_cast<std::ptrdiff_t>(to),
                       [](std::byte b) { return b == std::byte{0}; });
  };
  if (const std::uint64_t end = at.cells_at + at.cells;
      (lattice.distances() && !isZero(2, at.cells_at)) || !isZero(end, at.table_at))
    return Error{ErrorCode::kCorrupt, "a reserved byte of a grid is not zero", end};
  const std::span<const std::byte> bytes =
      chunk.subspan(static_cast<std::size_t>(at.cells_at), static_cast<std::size_t>(at.cells));
  const auto inChunk = [&](Error error) {
    error.offset += at.cells_at;
    return error;
  };
  const Result<std::uint32_t> stored = countStored(bytes, lattice);
  if (!stored) return inChunk(stored.error());
  if (const Result<void> pages = parsePages(chunk, at.table_at, bricks, *stored, lattice.channels, out.pages);
      !pages)
    return pages;
  if (out.pages.size() >= kMaxPages) return Error{ErrorCode::kLimit, "a level has more than 131071 pages", 0};
  if (!out.cells.reset(at.cells) || !out.bricks.reset(*stored))
    return Error{ErrorCode::kOutOfMemory, "no memory for a grid", 0};
  if (const Result<void> loaded = loadCells(bytes, lattice, out); !loaded) return inChunk(loaded.error());
  return {};
}

Result<void> parsePages(std::span<const std::byte> chunk, std::uint64_t table_at,
                        const Pack::ChunkInfo& stored, std::uint32_t bricks, int channels,
                        Buffer<PageInfo>& out) {
  if (!out.reset((chunk.size() - table_at) / layout::kPageEntryBytes))
    return Error{ErrorCode::kOutOfMemory, "no memory for a grid", 0};
  // Pages follow each other without gaps, in bytes and in slots, and cover the chunk and all bricks.
  std::uint64_t offset = 0, slot = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(table_at) + i * layout::kPageEntryBytes;
    PageInfo page;
    page.offset = layout::load<std::uint64_t>(chunk, at);
    page.stored = layout::load<std::uint32_t>(chunk, at + 8);
    page.raw = layout::load<std::uint32_t>(chunk, at + 12);
    page.checksum = layout::load<std::uint64_t>(chunk, at + 16);
    page.first_slot = layout::load<std::uint32_t>(chunk, at + 24);
    page.count = layout::load<std::uint32_t>(chunk, at + 28);
    page.channels = static_cast<std::uint8_t>(channels);
    if (!isPossiblePage(page)) return Error{ErrorCode::kCorrupt, "a page's sizes are impossible", at + 8};
    if (page.offset != offset || page.stored > stored.stored - offset)
      return Error{ErrorCode::kCorrupt, "a page does not start where the previous one ends", at};
    if (page.first_slot != slot || page.count > bricks - slot)
      return Error{ErrorCode::kCorrupt, "a page's slots do not follow the previous page's", at + 24};
    offset += page.stored;
    slot += page.count;
    page.offset += stored.offset;
    out[i] = page;
  }
  if (offset != stored.stored)
    return Error{ErrorCode::kCorrupt, "the pages do not fill the chunk of bricks", table_at};
  if (slot != bricks) return Error{ErrorCode::kCorrupt, "the pages do not hold every brick", table_at};
  return {};
}

Result<LevelGrid> readLevelGrid(const Source& source, const Pack::ChunkInfo& chunk,
                                const Pack::ChunkInfo& bricks, const Lattice& lattice,
                                const PackLimits& limits, const Allocator& allocator) {
  // Checked before memory is allocated: the chunk has all cells, and no more pages than bricks or than the
  // stored bytes can hold.
  const GridPlaces at(lattice);
  const std::uint64_t least_page = lattice.channels > 0 ? layout::kLeastFrame : 1;
  if (chunk.raw < at.table_at ||
      (chunk.raw - at.table_at) / layout::kPageEntryBytes > std::min(at.cells, bricks.stored / least_page)) {
    return Error{ErrorCode::kCorrupt, "a grid's size does not match the part's size", chunk.offset};
  }
  if (at.cells > limits.max_decoded_bytes / kCellMemory)
    return Error{ErrorCode::kLimit, "a grid takes more memory than max_decoded_bytes", chunk.offset};
  Buffer<std::byte> bytes(allocator);
  if (const Result<void> read = readChunk(source, chunk, limits, bytes, allocator); !read)
    return read.error();
  LevelGrid grid(allocator);
  if (const Result<void> parsed = parseGrid(bytes.span(), lattice, bricks, grid); !parsed)
    return inFile(parsed.error(), chunk);
  bytes = Buffer<std::byte>(allocator);  // before more is allocated
  if (!lattice.distances() && !growBoxes(grid.cells.span(), grid.grid, allocator))
    return Error{ErrorCode::kOutOfMemory, "no memory for a grid", chunk.offset};
  return Result<LevelGrid>(std::move(grid));
}

bool isPossiblePage(const PageInfo& page) {
  if (page.stored < 1 || page.stored > layout::kMaxPageStored || page.raw > layout::kMaxPageRaw ||
      page.count < 1 || page.count > kMaxPageBricks)
    return false;
  if (page.channels == PageInfo::kDistances) return page.raw == page.count * layout::kDistanceBrick;
  if (page.channels > 0) return page.channels <= 2 && page.raw == page.count * page.channels * kFogSamples;
  return page.raw >= page.count * kBrickVoxels &&
         (page.raw - page.count * kBrickVoxels) % sizeof(std::uint32_t) == 0;
}

Result<void> readStored(const Source& source, const PageInfo& page, std::span<std::byte> stored) {
  if (const Result<void> read = readBytes(source, page.offset, stored); !read) return read;
  if (checksum(stored) != page.checksum)
    return Error{ErrorCode::kChecksum, "a page differs from its checksum", page.offset};
  return {};
}

Result<void> decodeFogPage(const Source& source, const PageInfo& page, PageData& out) {
  // One block of memory for everything that decoding needs: workspace of zstd, stored page.
  const std::size_t workspace_bytes = static_cast<std::size_t>(layout::align(decodeWorkspaceBytes(), 16));
  if (!out.scratch.reuse(workspace_bytes + page.stored) || !out.shapes.reuse(0) || !out.fog.reuse(page.raw))
    return Error{ErrorCode::kOutOfMemory, "no memory for a page", page.offset};
  const std::span<std::byte> stored = out.scratch.span().subspan(workspace_bytes, page.stored);
  if (const Result<void> read = readStored(source, page, stored); !read) return read;
  out.info = page;
  if (!decodeFrame(stored, std::as_writable_bytes(out.fog.span()), out.scratch.span().first(workspace_bytes)))
    return Error{ErrorCode::kCorrupt, "a page does not decompress to its raw size", page.offset};
  return {};
}

Result<void> decodeSolidPage(const Source& source, const LevelGrid& grid, std::size_t index,
                             const LevelAbove& given, std::size_t palette, std::span<std::uint32_t> words,
                             PageData& out) {
  const PageInfo& page = grid.pages[index];
  const LevelAbove above = grid.coarsest ? LevelAbove() : given;
  PageFrame frame;
  if (const Result<void> made = frame.make(grid, index, above, palette); !made) return made;
  if (!out.scratch.reuse(page.stored) || !out.shapes.reuse(page.count) || !out.fog.reuse(0))
    return Error{ErrorCode::kOutOfMemory, "no memory for a page", page.offset};
  if (const Result<void> read = readStored(source, page, out.scratch.span()); !read) return read;
  if (const Result<void> decoded =
          decodeSolidPage(frame.shape, out.scratch.span(), out.workspace, out.shapes.span(),
                          words.subspan(std::size_t{page.count} * kBrickWords));
      !decoded)
    return Error{decoded.error().code, decoded.error().detail, page.offset};
  out.info = page;
  writeBricks(grid, index, above, out.shapes.span(), words);
  return {};
}

void writeFog(const PageInfo& page, std::span<const std::uint8_t> samples, std::span<std::uint32_t> words) {
  std::uint32_t* word = words.data();
  for (std::size_t b = 0; b < page.count; ++b) {
    for (std::size_t channel = 0; channel < page.channels; ++channel) {
      const std::uint8_t* const brick = samples.data() + (channel * page.count + b) * kFogSamples;
      for (int z = 0; z < kFogSide; ++z) {
        for (int y = 0; y < kBrickSide; ++y) {
          const std::uint8_t* const row = brick + kFogSide * (y + kFogSide * z);
          for (int x = 0; x < kBrickSide; ++x) {
            const std::uint8_t* const s = row + x;
            *word++ = std::uint32_t{s[0]} | std::uint32_t{s[1]} << 8 | std::uint32_t{s[kFogSide]} << 16 |
                      std::uint32_t{s[kFogSide + 1]} << 24;
          }
        }
      }
    }
  }
}

std::uint32_t pageWords(const PageInfo& page) {
  if (page.channels == PageInfo::kDistances) return kCodeWords * page.count;
  if (page.channels > 0) return kFogChannelWords * page.channels * page.count;
  const std::uint32_t attributes = (page.raw - page.count * kBrickVoxels) / sizeof(std::uint32_t);
  return kBrickWords * page.count + attributes;
}

std::span<const std::uint8_t> fogChannel(const PageData& page, int channel) {
  const std::size_t bytes = std::size_t{page.info.count} * kFogSamples;
  return page.fog.span().subspan(static_cast<std::size_t>(channel) * bytes, bytes);
}

std::int64_t findClearBrick(std::span<const std::uint8_t> fog, int channels) {
  const std::size_t bricks = fog.size() / (static_cast<std::size_t>(channels) * kFogSamples);
  for (std::size_t brick = 0; brick < bricks; ++brick) {
    bool clear = true;
    for (std::size_t channel = 0; channel < static_cast<std::size_t>(channels); ++channel) {
      const auto samples = fog.subspan((channel * bricks + brick) * kFogSamples, kFogSamples);
      clear = clear &&
              std::all_of(samples.begin(), samples.end(), [](std::uint8_t sample) { return sample == 0; });
    }
    if (clear) return static_cast<std::int64_t>(brick);
  }
  return -1;
}

bool hasFogOutside(std::span<const std::uint8_t> channel, const glm::ivec3& brick,
                   const glm::ivec3& samples) {
  const glm::ivec3 room = samples - brick * kBrickSide;
  if (room.x >= kFogSide && room.y >= kFogSide && room.z >= kFogSide) return false;
  for (int i = 0; i < kFogSamples; ++i) {
    const bool inside =
        i % kFogSide < room.x && i / kFogSide % kFogSide < room.y && i / (kFogSide * kFogSide) < room.z;
    if (!inside && channel[static_cast<std::size_t>(i)] != 0) return true;
  }
  return false;
}

std::int64_t findBrickWithoutSurface(std::span<const std::uint8_t> codes) {
  for (std::size_t brick = 0; brick * kBrickVoxels < codes.size(); ++brick) {
    const auto voxels = codes.subspan(brick * kBrickVoxels, kBrickVoxels);
    if (std::none_of(voxels.begin(), voxels.end(), isSurfaceCode)) return static_cast<std::int64_t>(brick);
  }
  return -1;
}

std::int64_t findWrongPaletteIndex(std::span<const std::uint32_t> attributes, std::size_t palette_size) {
  // Compares only the greatest index first, which the compiler does with SIMD. It is nearly always valid.
  std::uint32_t greatest = 0;
  for (const std::uint32_t a : attributes) greatest = std::max(greatest, a & 0xffu);
  if (greatest < palette_size) return -1;
  return std::find_if(attributes.begin(), attributes.end(),
                      [&](std::uint32_t a) { return attributePalette(a) >= palette_size; }) -
         attributes.begin();
}

bool hasSolidOutside(std::span<const std::uint8_t> codes, const glm::ivec3& brick, const glm::ivec3& size) {
  const glm::ivec3 room = size - brick * kBrickSide;  // the level's voxels from the brick's corner on
  if (room.x >= kBrickSide && room.y >= kBrickSide && room.z >= kBrickSide) return false;
  for (int i = 0; i < kBrickVoxels; ++i) {
    const bool inside = (i & 7) < room.x && ((i >> 3) & 7) < room.y && (i >> 6) < room.z;
    if (!inside && isSolidCode(codes[static_cast<std::size_t>(i)])) return true;
  }
  return false;
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
#include "distance_pages.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "coding_libraries.h"
#include "container.h"
#include "layout.h"
#include "morton_walk.h"
#include "voxels.h"

namespace kelp {
namespace {

// Cells as the file has them, a byte each.
constexpr std::uint8_t kCellFarOutside = 0, kCellFarInside = 1, kCellStored = 2;

// Which numbers are sums of three squares.
constexpr std::array<bool, 256> kSumOfSquares = [] {
  std::array<bool, 256> sums{};
  for (std::size_t x = 0; x < 16; ++x)
    for (std::size_t y = x; y < 16; ++y)
      for (std::size_t z = y; z < 16; ++z)
        if (const std::size_t sum = x * x + y * y + z * z; sum < sums.size()) sums[sum] = true;
  return sums;
}();

// Gives the bytes of the file their meaning, and slots to stored bricks.
Result<std::uint32_t> readCells(std::span<const std::byte> bytes, const glm::ivec3& grid,
                                std::span<std::uint32_t> cells) {
  std::uint32_t next = 0;
  for (MortonWalk walk(grid); !walk.done(); walk.next()) {
    const auto at = static_cast<std::size_t>(walk.index());
    const auto byte = static_cast<std::uint8_t>(bytes[at]);
    if (byte > kCellStored || next > kCellSlotMask)
      return Error{ErrorCode::kCorrupt, "a cell of distances is none of 0, 1 and 2, or one too many", at};
    cells[at] = byte == kCellStored       ? kCellSolid | next++
                : byte == kCellFarOutside ? std::uint32_t{kFarOutside}
                                          : std::uint32_t{kFarInside};
  }
  if (next == 0) return Error{ErrorCode::kCorrupt, "a level of distances has no brick", 0};
  return next;
}

Result<void> parseDistanceGrid(std::span<const std::byte> chunk, const Pack::ChunkInfo& stored,
                               DistanceGrid& out) {
  const std::uint64_t cells = cellCount(out.grid);
  const std::uint64_t table_at = layout::align(layout::kDgrdHeader + cells, 8);
  out.band = {layout::load<std::uint8_t>(chunk, 0), layout::load<std::uint8_t>(chunk, 1)};
  if (!isPossibleBand(out.band))
    return Error{ErrorCode::kCorrupt, "a band of distances is not 16 to 225 outside and 4 to 28 inside", 0};
  if (!out.cells.reset(cells)) return Error{ErrorCode::kOutOfMemory, "no memory for a grid", 0};
  const auto isZero = [&](std::uint64_t from, std::uint64_t to) {
    return std::all_of(chunk.begin() + static_cast<std::ptrdiff_t>(from),
                       chunk.begin() + static_cast<std::ptrdiff_t>(to),
                       [](std::byte b) { return b == std::byte{0}; });
  };
  if (!isZero(2, layout::kDgrdHeader) || !isZero(layout::kDgrdHeader + cells, table_at))
    return Error{ErrorCode::kCorrupt, "a reserved byte of a grid of distances is not zero", 2};
  const Result<std::uint32_t> count = readCells(
      chunk.subspan(layout::kDgrdHeader, static_cast<std::size_t>(cells)), out.grid, out.cells.span());
  if (!count)
    return Error{ErrorCode::kCorrupt, count.error().detail, layout::kDgrdHeader + count.error().offset};
  if (!out.bricks.reset(*count)) return Error{ErrorCode::kOutOfMemory, "no memory for a grid", 0};
  listBricks(out.cells.span(), out.grid, out.bricks.span());
  return parsePages(chunk, table_at, stored, *count, layout::kDistanceChannels, out.pages);
}

}  // namespace

bool isPossibleBand(DistanceBand band) {
  return band.outside >= kNarrowestBand.outside && band.outside <= kWidestBand.outside &&
         band.inside >= kNarrowestBand.inside && band.inside <= kWidestBand.inside;
}

Result<std::uint32_t> checkDistanceCells(std::span<const std::uint32_t> cells, const glm::ivec3& grid) {
  std::uint32_t next = 0;
  for (MortonWalk walk(grid); !walk.done(); walk.next()) {
    const std::uint32_t cell = cells[static_cast<std::size_t>(walk.index())];
    if (cell == kFarOutside || cell == kFarInside) continue;
    if (next > kCellSlotMask || cell != (kCellSolid | next))
      return Error{ErrorCode::kCorrupt, "a cell's slot is not the next in Morton order", walk.index()};
    ++next;
  }
  if (next == 0) return Error{ErrorCode::kCorrupt, "a level of distances has no brick", 0};
  return next;
}

void listBricks(std::span<const std::uint32_t> cells, const glm::ivec3& grid,
                std::span<std::uint32_t> bricks) {
  for (MortonWalk walk(grid); !walk.done(); walk.next())
    if (const std::uint32_t cell = cells[static_cast<std::size_t>(walk.index())]; cell & kCellSolid)
      bricks[cell & kCellSlotMask] = static_cast<std::uint32_t>(walk.index());
}

void storeDistanceCells(const DistanceLevel& level, std::span<std::byte> chunk) {
  layout::store(chunk, 0, level.band.outside);
  layout::store(chunk, 1, level.band.inside);
  for (std::size_t i = 0; i < level.cells.size(); ++i)
    chunk[layout::kDgrdHeader + i] = static_cast<std::byte>(level.cells[i] & kCellSolid     ? kCellStored
                                                            : level.cells[i] == kFarOutside ? kCellFarOutside
                                                                                            : kCellFarInside);
}

Result<DistanceGrid> readDistanceLevel(const Source& source, const Pack::ChunkInfo& chunk,
                                       const Pack::ChunkInfo& pages, const glm::ivec3& size,
                                       const Limits& limits, const Allocator& allocator) {
  DistanceGrid grid(allocator);
  grid.size = size;
  grid.grid = brickGrid(size);
  // Checked before memory is allocated, as for GRID. An index of a cell fits 32 bits, and all cells fit what
  // a chunk may decode to.
  const std::uint64_t cells = cellCount(grid.grid), table_at = layout::align(layout::kDgrdHeader + cells, 8);
  if (chunk.raw < table_at || (chunk.raw - table_at) % layout::kPageEntryBytes != 0 ||
      (chunk.raw - table_at) / layout::kPageEntryBytes > std::min(cells, pages.stored / layout::kLeastFrame))
    return Error{ErrorCode::kCorrupt, "a grid's size does not match the part's size", chunk.offset};
  if (cells > ~std::uint32_t{0} || cells * sizeof(std::uint32_t) > limits.max_decoded_bytes)
    return Error{ErrorCode::kLimit, "a chunk is larger than the limits allow", chunk.offset};
  Buffer<std::byte> bytes(allocator);
  if (const Result<void> read = readChunk(source, chunk, limits, bytes, allocator); !read)
    return read.error();
  if (const Result<void> parsed = parseDistanceGrid(bytes.span(), pages, grid); !parsed)
    return inFile(parsed.error(), chunk);
  return Result<DistanceGrid>(std::move(grid));
}

void predictDistances(const DistanceLevel& level, std::uint32_t first_slot, std::span<const BrickBits> bits,
                      std::size_t brick, std::span<std::uint8_t, kBrickVoxels> codes) {
  constexpr int kOneBrick = 81;  // nearer than this, everything is in the bricks that touch
  const int reach = std::max(level.band.outside, level.band.inside) < kOneBrick ? 1 : 2;
  const glm::ivec3 middle = brickAt(level, first_slot + brick);
  const glm::ivec3 low = glm::max(middle - reach, glm::ivec3(0)),
                   high = glm::min(middle + reach, level.grid - 1);
  std::array<const BrickBits*, 125> around{};
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const std::size_t at = static_cast<std::size_t>(x) +
                               static_cast<std::size_t>(level.grid.x) *
                                   (static_cast<std::size_t>(y) +
                                    static_cast<std::size_t>(level.grid.y) * static_cast<std::size_t>(z));
        const std::uint32_t cell = level.cells[at], slot = cell & kCellSlotMask;
        if (!(cell & kCellSolid) || slot < first_slot || slot - first_slot >= bits.size()) continue;
        const glm::ivec3 from = glm::ivec3(x, y, z) - middle + 2;
        around[static_cast<std::size_t>(from.x + 5 * (from.y + 5 * from.z))] = &bits[slot - first_slot];
      }
    }
  }
  computeDistanceCodes(around, level.band, codes);
}

const char* findDistanceFault(const DistanceLevel& level, const glm::ivec3& brick,
                              std::span<const std::uint8_t> codes, std::span<const std::uint8_t> predicted) {
  const glm::ivec3 room = level.size - brick * kBrickSide;
  bool outside = true, inside = true;
  for (int i = 0; i < kBrickVoxels; ++i) {
    const std::uint8_t code = codes[static_cast<std::size_t>(i)],
                       most = predicted[static_cast<std::size_t>(i)];
    outside = outside && code == kFarOutside;
    inside = inside && code == kFarInside;
    if (isInside(code) && ((i & 7) >= room.x || (i >> 3 & 7) >= room.y || i >> 6 >= room.z))
      return "a solid voxel of distances lies outside the level";
    if (code == most) continue;
    const int squared = squaredOf(code), allowed = squaredOf(most);
    if (squared == 0 || isInside(code) != isInside(most) || (allowed != 0 && squared > allowed) ||
        squared > (isInside(code) ? level.band.inside : level.band.outside) ||
        !kSumOfSquares[static_cast<std::size_t>(squared)])
      return "a distance is impossible";
  }
  return outside || inside ? "a stored brick of distances is wholly beyond the band" : nullptr;
}

Result<void> decodeDistancePage(const Source& source, const DistanceLevel& level, const PageInfo& page,
                                DistancePage& out) {
  // As in decodePage: workspace of zstd, decoded page, stored page.
  const std::size_t workspace_bytes = static_cast<std::size_t>(layout::align(decodeWorkspaceBytes(), 16));
  const std::size_t raw_bytes = static_cast<std::size_t>(layout::align(page.raw, 16));
  if (!out.scratch.reuse(workspace_bytes + raw_bytes + page.stored) || !out.bits.reuse(page.count) ||
      !out.codes.reuse(std::size_t{page.count} * kBrickVoxels))
    return Error{ErrorCode::kOutOfMemory, "no memory for a page", page.offset};
  const std::span<std::byte> workspace = out.scratch.span().first(workspace_bytes);
  const std::span<std::byte> raw = out.scratch.span().subspan(workspace_bytes, page.raw);
  const std::span<std::byte> stored = out.scratch.span().subspan(workspace_bytes + raw_bytes, page.stored);
  if (const Result<void> read = readBytes(source, page.offset, stored); !read) return read;
  if (checksum(stored) != page.checksum)
    return Error{ErrorCode::kChecksum, "a page differs from its checksum", page.offset};
  if (!decodeFrame(stored, raw, workspace))
    return Error{ErrorCode::kCorrupt, "a page does not decompress to its raw size", page.offset};

  out.first_slot = page.first_slot;
  out.count = page.count;
  std::memcpy(out.bits.data(), raw.data(), out.bits.size() * sizeof(BrickBits));
  const std::span<const std::byte> corrections = raw.subspan(out.bits.size() * sizeof(BrickBits));
  for (std::size_t brick = 0; brick < page.count; ++brick) {
    std::array<std::uint8_t, kBrickVoxels> predicted;
    predictDistances(level, page.first_slot, out.bits.span(), brick, predicted);
    const std::span<std::uint8_t> codes = out.codes.span().subspan(brick * kBrickVoxels, kBrickVoxels);
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const auto squared = static_cast<std::uint8_t>(corrections[brick * kBrickVoxels + i]);
      codes[i] = predicted[i];
      if (squared == 0) continue;
      if (squared == squaredOf(predicted[i]) || squared > kWidestBand.outside ||
          (isInside(predicted[i]) && squared > kWidestBand.inside))
        return Error{ErrorCode::kCorrupt, "a distance is impossible", page.offset};
      codes[i] = isInside(predicted[i]) ? static_cast<std::uint8_t>(255 - squared) : squared;
    }
    if (const char* fault =
            findDistanceFault(level, brickAt(level, page.first_slot + brick), codes, predicted))
      return Error{ErrorCode::kCorrupt, fault, page.offset};
  }
  return {};
}

}  // namespace kelp

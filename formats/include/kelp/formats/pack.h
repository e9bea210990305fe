// SPDX-License-Identifier: MIT
// Reader of .kelp packs. Never trusts a byte: everything is checked before it is used, memory is bounded before it is allocated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "kelp/formats/brick.h"
#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/model.h"
#include "kelp/formats/source.h"

namespace kelp {

inline constexpr std::uint16_t kFormatMajor = 1;
inline constexpr std::uint16_t kFormatMinor = 1;  // the newest known; packs without fog are written as 0

// What a pack may ask for at most; kLimit beyond. With what a file holds, they bound the memory that it can make the reader take, before any is taken:
// - Pack::open: twice max_metadata_bytes, twice the file's size, and a quarter of a MiB;
// - readGrid: nine quarters of the grid as it is decoded, which is at most max_decoded_bytes and 32768 times what is stored, then what is stored, and a quarter of a MiB;
// - readPage: half a MiB, kept in the PageData.
struct Limits {
  std::uint64_t max_decoded_bytes = std::uint64_t{4} << 30;  // of any one chunk
  std::uint32_t max_side = 8192;                             // level-0 voxels along an axis
  std::uint32_t max_parts = 4096;
  std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;  // of all metadata together: decoded, and as tables in memory (a wave takes 228 bytes, a key 52)
};

// One page of bricks as the file holds it: loads alone.
struct PageInfo {
  std::uint64_t offset = 0;  // in the file
  std::uint32_t stored = 0;  // bytes in the file (one zstd frame)
  std::uint32_t raw = 0;     // bytes decoded, at most 64 KiB
  std::uint64_t checksum = 0;
  std::uint32_t first_slot = 0;
  std::uint32_t count = 0;   // bricks
  std::uint8_t channels = 0;  // 0: codes and attributes; 1: density; 2: density and heat
};

// The grid of one level of one part and the pages that hold its bricks.
struct LevelGrid {
  LevelGrid() = default;
  explicit LevelGrid(const Allocator& allocator) : cells(allocator), pages(allocator) {}

  glm::ivec3 size{0};             // voxels, or cubes of fog, of this level
  glm::ivec3 grid{0};             // bricks
  std::uint32_t bricks = 0;       // stored bricks; slots are 0 .. bricks - 1, each used by exactly one cell
  Buffer<std::uint32_t> cells;    // grid.x * grid.y * grid.z, x fastest, then y, then z (see brick.h)
  Buffer<PageInfo> pages;         // ascending slots, no gaps
};

// One decoded page. Keep one per thread and read page after page into it: after the largest page it allocates no more.
struct PageData {
  PageData() = default;
  explicit PageData(const Allocator& allocator) : codes(allocator), attributes(allocator), fog(allocator), scratch(allocator) {}

  std::uint32_t first_slot = 0;
  std::uint32_t count = 0;
  Buffer<std::uint8_t> codes;         // 512 a brick
  Buffer<std::uint32_t> attributes;   // of all surface voxels, brick by brick, in code order
  Buffer<std::uint8_t> fog;           // 729 densities a brick, then 729 heats a brick (kelp/formats/fog.h); then codes and attributes are empty
  Buffer<std::byte> scratch;          // the reader's own
};

// An open pack: everything but the voxels is in memory and checked. Immutable; every const function may be called from any thread.
// Movable. The source's `user` must outlive it.
class Pack {
 public:
  // Reads and checks header, index and metadata. Errors: all but kMisuse's siblings kNotMonotone (kCorrupt is answered) and kGraphics.
  static Result<Pack> open(const Source& source, const Limits& limits = {}, const Allocator& allocator = {});
  Pack(Pack&&) noexcept;
  Pack& operator=(Pack&&) noexcept;
  ~Pack();

  std::uint16_t minorVersion() const;
  std::uint64_t fileSize() const;
  std::string_view infoJson() const;            // INFO, UTF-8, as stored; it was not parsed
  std::span<const Part> parts() const;
  std::span<const Material> palette() const;    // 1 to 256
  std::span<const Clip> clips() const;

  // Reads, checks and decodes the grid of a level. kMisuse for a part or level that is not there.
  Result<LevelGrid> readGrid(int part, int level) const;
  // Reads, checks and decodes one page of a grid that readGrid of this pack gave. `out` is reused: no allocation when it is large enough.
  Result<void> readPage(const PageInfo& page, PageData& out) const;

  // The chunks, for tools that say where the bytes go. fourcc has its first letter in the lowest byte.
  struct ChunkInfo {
    std::uint32_t fourcc = 0, flags = 0, level = 0, part = 0;
    std::uint64_t offset = 0, stored = 0, raw = 0, checksum = 0;
  };
  std::span<const ChunkInfo> chunks() const;

 private:
  struct Impl;
  explicit Pack(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kelp

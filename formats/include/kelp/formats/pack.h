// SPDX-License-Identifier: MIT
// Reader of .kelp packs. Safe for hostile files: everything is checked before it is used, and every size is
// checked before memory is allocated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/model.h"
#include "kelp/formats/source.h"

namespace kelp {

inline constexpr std::uint16_t kFormatMajor = 1;
inline constexpr std::uint16_t kFormatMinor = 3;

// Bounds on a pack; kLimit beyond. PackLimits and file size together bound the memory that the reader
// takes:
// - Pack::open: at most 2 max_metadata_bytes + 2 file sizes + 1/4 MiB;
// - readGrid, readDistanceGrid: at most 9/4 of the decoded grid + its stored size + 1/4 MiB + 4 bytes for
//   each brick of the grid, for each that is stored and for each corner of bricks. A decoded grid has at most
//   32768 times its stored size, and a grid at most max_decoded_bytes / 16 bricks;
// - readPage: at most 1/2 MiB, kept in the PageData.
struct PackLimits {
  std::uint64_t max_decoded_bytes = std::uint64_t{4} << 30;  // of any one chunk
  std::uint32_t max_side = 8192;                             // level-0 voxels along an axis
  std::uint32_t max_parts = 4096;
  // Of all metadata together: once as decoded bytes, once as tables in memory. A wave counts kWaveMemory
  // bytes, a key 52, a cell of a cage some 160, of which 72 are free again once the pack is open.
  std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;
};

// Bytes that a wave counts for PackLimits::max_metadata_bytes: its entry in the Pack, and what the runtime
// prepares from it.
inline constexpr std::size_t kWaveMemory = 784;

struct LevelGrid;  // these three: kelp/formats/level.h and page.h
struct LevelAbove;
struct PageData;

// An open pack. Everything except the voxels is in memory and checked. Movable. Immutable: any thread may
// call any const function at any time.
class Pack {
 public:
  // Reads and checks header, index and metadata. Any error except kNotMonotone and kFolds (a rest rig that
  // turns back or folds is kCorrupt) and kGraphics. kNotYet: open it again later. Safe for hostile files.
  static Result<Pack> open(const Source& source, const PackLimits& limits = {},
                           const Allocator& allocator = {});
  Pack(Pack&&) noexcept;
  Pack& operator=(Pack&&) noexcept;
  ~Pack();

  std::uint16_t minorVersion() const;
  std::uint64_t fileSize() const;
  std::string_view infoJson() const;  // chunk INFO as stored: UTF-8, not parsed
  std::span<const Part> parts() const;
  std::span<const Material> palette() const;  // 1 to 256
  std::span<const Clip> clips() const;
  std::span<const Socket> sockets() const;
  std::span<const Joint> joints() const;  // of the skin that the parts were made of

  // Reads, checks and decodes the grid of a level. kMisuse for a part or level that does not exist.
  Result<LevelGrid> readGrid(int part, int level) const;

  // True if the pack holds distances: of all levels of all its solid parts, or of none.
  bool hasDistances() const;
  // Levels of distances of a part, at least as many as it has levels of voxels; 0 if there are none.
  int distanceLevels(int part) const;
  // Like readGrid, for distances.
  Result<LevelGrid> readDistanceGrid(int part, int level) const;

  // Reads, checks and decodes a page of a grid of this pack, straight into `words` (kelp/formats/page.h), of
  // which there must be pageWords(). Uses the other memory of `out`; allocates only if it is too small.
  // above: of voxels that are not of the coarsest level: the next coarser level of the same part. kMisuse:
  // there is no such page, or the shape of a stored brick over the page is not known; those beside that are
  // not known count as solid. PagesAbove says which pages make them known.
  Result<void> readPage(const LevelGrid& grid, std::size_t page, const LevelAbove& above,
                        std::span<std::uint32_t> words, PageData& out) const;
  // The same into out.words.
  Result<void> readPage(const LevelGrid& grid, std::size_t page, const LevelAbove& above,
                        PageData& out) const;

  // The chunks of the file, for tools. The first letter of a fourcc is in its lowest byte.
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

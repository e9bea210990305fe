// SPDX-License-Identifier: MIT
// Header and index: which chunks a file has, and whether they keep the rules and the order of SPEC.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/pack.h"

namespace kelp {

struct Container {
  explicit Container(const Allocator& allocator) : chunks(allocator) {}

  std::uint16_t minor = 0;
  std::uint64_t file_size = 0;
  Buffer<Pack::ChunkInfo> chunks;
};

// Reads and checks header and index, and reads nothing else.
Result<void> readContainer(const Source& source, const PackLimits& limits, const Allocator& allocator,
                           Container& out);

// Fills `bytes` from `offset` of the source, or returns kIo or kNotYet.
Result<void> readBytes(const Source& source, std::uint64_t offset, std::span<std::byte> bytes);

// Reads a chunk, checks its checksum and decompresses it if necessary. Not for BRCK and FOGB.
Result<void> readChunk(const Source& source, const Pack::ChunkInfo& chunk, const PackLimits& limits,
                       Buffer<std::byte>& out, const Allocator& allocator);

// Moves the offset of an error from the chunk to the file. Bytes in a compressed chunk have no place in the
// file, so there it is the start of the chunk.
Error inFile(const Error& error, const Pack::ChunkInfo& chunk);

// Where the metadata chunks are in the index.
struct MetadataChunks {
  static constexpr std::size_t kNone = ~std::size_t{0};
  // info, fogs, clip, sock, jnts and cage may be absent
  std::size_t info = kNone, part = kNone, matl = kNone, fogs = kNone, rigs = kNone, clip = kNone,
              sock = kNone, jnts = kNone, cage = kNone;
};
// Finds the metadata chunks and checks their order. kLimit if together they are larger than the limits
// allow.
Result<MetadataChunks> findMetadata(std::span<const Pack::ChunkInfo> chunks, const PackLimits& limits);

// Index of the GRID chunk of every level of every part: grids[first[part] + level]. bricks has the index of
// its BRCK or FOGB chunk.
struct LevelChunks {
  explicit LevelChunks(const Allocator& allocator)
      : first(allocator),
        grids(allocator),
        bricks(allocator),
        first_distances(allocator),
        distance_grids(allocator),
        distance_pages(allocator) {}

  Buffer<std::uint32_t> first;  // one a part
  Buffer<std::uint32_t> grids, bricks;
  // The same for DGRD and DIST; of length 0 if there are none.
  Buffer<std::uint32_t> first_distances, distance_grids, distance_pages;
};
// Finds the GRID and BRCK or FOGB chunks, and checks that they are there for each level, coarse to fine, of
// each part; and after them DGRD and DIST, for each level of distances of each solid part, or none at all.
Result<void> findLevels(std::span<const Pack::ChunkInfo> chunks, std::span<const Part> parts,
                        LevelChunks& out);

}  // namespace kelp

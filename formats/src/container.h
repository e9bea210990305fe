// SPDX-License-Identifier: MIT
// Header and index: which chunks a file holds, where, and whether they are the ones, in the order, that SPEC.md asks for.
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

// Reads and checks header and index. Reads nothing beyond them.
Result<void> readContainer(const Source& source, const Limits& limits, const Allocator& allocator, Container& out);

// Fills `bytes` from `offset` of the source, or answers kIo.
Result<void> readBytes(const Source& source, std::uint64_t offset, std::span<std::byte> bytes);

// Reads a chunk, checks its checksum and decompresses it if it is compressed. Not for BRCK and FOGB.
Result<void> readChunk(const Source& source, const Pack::ChunkInfo& chunk, const Limits& limits, Buffer<std::byte>& out,
                       const Allocator& allocator);

// An error inside a chunk, moved to where it is in the file. Inside a compressed chunk bytes have no place of their own: its
// begin then.
Error inFile(const Error& error, const Pack::ChunkInfo& chunk);

// Where the metadata chunks are in the index.
struct MetadataChunks {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t info = kNone, part = kNone, matl = kNone, fogs = kNone, rigs = kNone, clip = kNone;  // info, fogs and clip may be absent
};
// Finds them and checks their order; kLimit when together they are larger than the limits allow.
Result<MetadataChunks> findMetadata(std::span<const Pack::ChunkInfo> chunks, const Limits& limits);

// Index of the GRID chunk of every level of every part: grids[first[part] + level]; its BRCK or FOGB chunk is the next known one.
struct LevelChunks {
  explicit LevelChunks(const Allocator& allocator) : first(allocator), grids(allocator), bricks(allocator) {}

  Buffer<std::uint32_t> first;  // one a part
  Buffer<std::uint32_t> grids, bricks;
};
// Checks that the chunks after the metadata are GRID and BRCK, or FOGB, of each level, coarse to fine, and of each part that has it; finds
// them.
Result<void> findLevels(std::span<const Pack::ChunkInfo> chunks, std::span<const Part> parts, LevelChunks& out);

}  // namespace kelp

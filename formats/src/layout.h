// SPDX-License-Identifier: MIT
// The numbers of the tables in formats/SPEC.md, for reader, writer and verifier.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "kelp/formats/pack.h"

namespace kelp::layout {

static_assert(std::endian::native == std::endian::little,
              "kelp reads and writes packs on little-endian machines only");

// 0xAB K E L P A K 0xBB CR LF ^Z LF. A transfer in text mode changes these bytes.
inline constexpr std::array<std::uint8_t, 12> kIdentifier = {0xAB, 'K',  'E',  'L',  'P',  'A',
                                                             'K',  0xBB, 0x0D, 0x0A, 0x1A, 0x0A};

constexpr std::uint32_t fourcc(const char (&name)[5]) {
  return static_cast<std::uint32_t>(name[0]) | (static_cast<std::uint32_t>(name[1]) << 8) |
         (static_cast<std::uint32_t>(name[2]) << 16) | (static_cast<std::uint32_t>(name[3]) << 24);
}
inline constexpr std::uint32_t kInfo = fourcc("INFO");
inline constexpr std::uint32_t kPart = fourcc("PART");
inline constexpr std::uint32_t kMatl = fourcc("MATL");
inline constexpr std::uint32_t kFogs = fourcc("FOGS");
inline constexpr std::uint32_t kRigs = fourcc("RIGS");
inline constexpr std::uint32_t kClip = fourcc("CLIP");
inline constexpr std::uint32_t kSock = fourcc("SOCK");
inline constexpr std::uint32_t kJnts = fourcc("JNTS");
inline constexpr std::uint32_t kCage = fourcc("CAGE");
inline constexpr std::uint32_t kGrid = fourcc("GRID");
inline constexpr std::uint32_t kBrck = fourcc("BRCK");
inline constexpr std::uint32_t kFogb = fourcc("FOGB");
inline constexpr std::uint32_t kDgrd = fourcc("DGRD");
inline constexpr std::uint32_t kDist = fourcc("DIST");

constexpr bool isKnown(std::uint32_t chunk) {
  return chunk == kInfo || chunk == kPart || chunk == kMatl || chunk == kFogs || chunk == kRigs ||
         chunk == kClip || chunk == kSock || chunk == kJnts || chunk == kCage || chunk == kGrid ||
         chunk == kBrck || chunk == kFogb || chunk == kDgrd || chunk == kDist;
}

// True if the chunk consists of pages, which are compressed one by one.
constexpr bool isPages(std::uint32_t chunk) { return chunk == kBrck || chunk == kFogb || chunk == kDist; }
// True if the chunk is a grid over pages.
constexpr bool isGrid(std::uint32_t chunk) { return chunk == kGrid || chunk == kDgrd; }

inline constexpr std::uint32_t kFlagRequired = 1;
inline constexpr std::uint32_t kFlagZstd = 2;
inline constexpr std::uint32_t kKnownFlags = kFlagRequired | kFlagZstd;

inline constexpr std::size_t kHeaderBytes = 64;
// offset of the checksum of header and index
inline constexpr std::size_t kHeaderChecksum = 56;
inline constexpr std::size_t kIndexEntryBytes = 48;
inline constexpr std::uint64_t kAlignment = 64;
inline constexpr std::uint32_t kMaxPageRaw = 64 * 1024;
inline constexpr std::uint32_t kMaxPageStored = 128 * 1024;
inline constexpr std::size_t kPageEntryBytes = 32;
inline constexpr std::uint32_t kMaxSide = 32768;  // level-0 voxels
inline constexpr std::uint32_t kMaxNameBytes = 255;
// Size of the smallest zstd frame that is not empty: magic number, descriptor, size, block header, one byte.
inline constexpr std::uint64_t kLeastFrame = 10;
// The most that zstd can expand: 128 KiB from a block of 4 bytes.
inline constexpr std::uint64_t kMaxExpansion = 32768;

constexpr std::uint64_t align(std::uint64_t n, std::uint64_t unit) { return (n + unit - 1) / unit * unit; }

// Loads the value at `at`. The caller has checked the size.
template <class T>
T load(std::span<const std::byte> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <class T>
void store(std::span<std::byte> bytes, std::size_t at, const T& value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

// An index entry: fourcc, flags, level, part, offset, stored size, raw size, checksum.
inline Pack::ChunkInfo loadIndexEntry(std::span<const std::byte> bytes, std::size_t at) {
  Pack::ChunkInfo chunk;
  chunk.fourcc = load<std::uint32_t>(bytes, at);
  chunk.flags = load<std::uint32_t>(bytes, at + 4);
  chunk.level = load<std::uint32_t>(bytes, at + 8);
  chunk.part = load<std::uint32_t>(bytes, at + 12);
  chunk.offset = load<std::uint64_t>(bytes, at + 16);
  chunk.stored = load<std::uint64_t>(bytes, at + 24);
  chunk.raw = load<std::uint64_t>(bytes, at + 32);
  chunk.checksum = load<std::uint64_t>(bytes, at + 40);
  return chunk;
}

inline void storeIndexEntry(std::span<std::byte> bytes, std::size_t at, const Pack::ChunkInfo& chunk) {
  store(bytes, at, chunk.fourcc);
  store(bytes, at + 4, chunk.flags);
  store(bytes, at + 8, chunk.level);
  store(bytes, at + 12, chunk.part);
  store(bytes, at + 16, chunk.offset);
  store(bytes, at + 24, chunk.stored);
  store(bytes, at + 32, chunk.raw);
  store(bytes, at + 40, chunk.checksum);
}

// Sizes of headers and records in the metadata chunks.
inline constexpr std::size_t kPartHeader = 8, kPartRecord = 120;
inline constexpr std::size_t kMatlHeader = 4, kMatlRecord = 36;
inline constexpr std::size_t kFogsHeader = 4, kFogRecord = 28, kRampRecord = 12;
inline constexpr float kMaxRoll = 3.14159274f;  // pi
inline constexpr std::size_t kRigsHeader = 8, kRigsPerPart = 24, kKnotRecord = 28;
inline constexpr std::size_t kClipHeader = 20, kClipRecord = 16, kWaveRecord = 32, kTrackRecord = 16,
                             kKeyRecord = 52;
inline constexpr std::size_t kSockHeader = 8, kSockRecord = 36;
inline constexpr std::size_t kJntsHeader = 12, kJntsRecord = 60;
inline constexpr std::size_t kCageTable = 4, kCageRecord = 20, kCageCounts = 5;
inline constexpr std::uint8_t kInfluenced = 16;  // the nodes of a part's cages follow parts
inline constexpr std::uint8_t kMorphed = 32;     // and morph targets move them
inline constexpr std::uint8_t kSectioned = 64;   // its sections have widths and twists
inline constexpr std::size_t kMorphCounts = 2;

// Distances: the header of DGRD; a brick in a page of DIST: its bits, then its corrections.
inline constexpr std::size_t kDgrdHeader = 8;
inline constexpr std::uint32_t kDistanceBrick = 64 + 512;

}  // namespace kelp::layout

// SPDX-License-Identifier: MIT
// formats/SPEC.md, section 3: header, index, chunks.
#include "rerigged.h"

#include <algorithm>
#include <cstring>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace kelp::view {
namespace {

using Chunk = Pack::ChunkInfo;

constexpr std::uint64_t kHeaderBytes = 64, kEntryBytes = 48, kAlignment = 64;

constexpr std::uint32_t fourcc(const char (&name)[5]) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<std::uint8_t>(name[i]);
  return value;
}
constexpr std::uint32_t kRigs = fourcc("RIGS"), kClip = fourcc("CLIP"), kSock = fourcc("SOCK");

template <class T>
void store(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::uint64_t aligned(std::uint64_t offset) { return (offset + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

Rerigged::Rerigged(const Source& original, const Pack& pack, const RigSketch& rigs) : original_(original) {
  struct Placed {
    Chunk chunk;
    bool is_new = false;
  };
  std::vector<Placed> chunks;
  for (const Chunk& chunk : pack.chunks()) {
    if (chunk.fourcc == kClip || chunk.fourcc == kSock) continue;
    if (chunk.fourcc != kRigs) {
      chunks.push_back({chunk});
      continue;
    }
    for (const Chunk& fresh : rigs.asset().pack().chunks()) {  // RIGS, and CLIP and SOCK if there are any
      if (fresh.fourcc == kRigs || fresh.fourcc == kClip || fresh.fourcc == kSock)
        chunks.push_back({fresh, true});
    }
  }

  const std::uint64_t index_end = kHeaderBytes + kEntryBytes * chunks.size();
  std::vector<std::byte> head(index_end);
  std::uint64_t end = index_end;
  std::size_t entry = kHeaderBytes;
  pieces_.resize(1);
  for (const auto& [chunk, is_new] : chunks) {
    const std::uint64_t offset = aligned(end);
    Piece piece{offset, chunk.stored, chunk.offset, {}};
    if (is_new) {
      const auto bytes = rigs.bytes().subspan(chunk.offset, chunk.stored);
      piece.bytes.assign(bytes.begin(), bytes.end());
    }
    pieces_.push_back(std::move(piece));
    end = offset + chunk.stored;
    store(head, entry, chunk.fourcc);
    store(head, entry + 4, chunk.flags);
    store(head, entry + 8, chunk.level);
    store(head, entry + 12, chunk.part);
    store(head, entry + 16, offset);
    store(head, entry + 24, chunk.stored);
    store(head, entry + 32, chunk.raw);
    store(head, entry + 40, chunk.checksum);
    entry += kEntryBytes;
  }
  size_ = end;

  constexpr unsigned char kIdentifier[12] = {0xAB, 'K',  'E',  'L',  'P',  'A',
                                             'K',  0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
  std::memcpy(head.data(), kIdentifier, sizeof kIdentifier);
  store(head, 12, kFormatMajor);
  store(head, 14, pack.minorVersion());
  store(head, 16, size_);
  store(head, 24, static_cast<std::uint32_t>(chunks.size()));
  store(head, 56, static_cast<std::uint64_t>(XXH3_64bits(head.data(), head.size())));
  pieces_[0] = {0, index_end, 0, std::move(head)};
}

Read Rerigged::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  const auto& self = *static_cast<const Rerigged*>(user);
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
  const std::uint64_t end = offset + bytes.size();
  auto piece = std::partition_point(self.pieces_.begin(), self.pieces_.end(),
                                    [&](const Piece& p) { return p.offset + p.size <= offset; });
  for (; piece != self.pieces_.end() && piece->offset < end; ++piece) {
    const std::uint64_t first = std::max(offset, piece->offset),
                        last = std::min(end, piece->offset + piece->size);
    const std::span<std::byte> into = bytes.subspan(first - offset, last - first);
    const std::uint64_t within = first - piece->offset;
    if (!piece->bytes.empty()) {
      std::copy_n(piece->bytes.begin() + static_cast<std::ptrdiff_t>(within), into.size(), into.begin());
    } else if (const Read read = self.original_.read(self.original_.user, piece->from + within, into);
               read != Read::kDone) {
      return read;
    }
  }
  return Read::kDone;
}

}  // namespace kelp::view

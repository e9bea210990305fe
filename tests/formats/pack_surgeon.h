// SPDX-License-Identifier: MIT
// Takes a pack apart and puts it together again with right checksums, so that tests can tell lies that only
// the structure gives away. Written from formats/SPEC.md with zstd and xxHash alone: it shares no code with
// the library.
#pragma once

#include <gtest/gtest.h>
#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace kelp::test {

using Bytes = std::vector<std::byte>;

template <class T>
T get(const Bytes& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <class T>
void set(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

inline Bytes zstdFrame(const Bytes& raw) {
  Bytes frame(ZSTD_compressBound(raw.size()));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), 3));
  return frame;
}

inline Bytes zstdDecode(const std::byte* frame, std::size_t size) {
  Bytes raw(ZSTD_getFrameContentSize(frame, size));
  EXPECT_EQ(ZSTD_decompress(raw.data(), raw.size(), frame, size), raw.size());
  return raw;
}

// True if bytes are one whole zstd frame that names the size of its content, at most 1 MiB.
inline bool isFrame(const Bytes& bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size > (1u << 20)) return false;
  Bytes raw(static_cast<std::size_t>(size));
  return ZSTD_decompress(raw.data(), raw.size(), bytes.data(), bytes.size()) == size;
}

struct PackSurgeon {
  struct Chunk {
    std::uint32_t fourcc = 0, flags = 0, level = 0, part = 0;
    Bytes content;                 // decoded; pages of bricks as they are stored
    std::uint64_t raw_lie = 0;     // stated instead of the decoded size if not 0
    std::uint64_t offset_lie = 0;  // added to the offset stated
    std::size_t gap = 0;           // zeros before it, beyond those that the alignment asks for
  };

  std::uint16_t major = 1, minor = 0;
  std::vector<Chunk> chunks;

  explicit PackSurgeon(const Bytes& file) {
    for (std::uint32_t i = 0; i < get<std::uint32_t>(file, 24); ++i) {
      const std::size_t at = 64 + 48 * std::size_t{i};
      Chunk chunk;
      chunk.fourcc = get<std::uint32_t>(file, at);
      chunk.flags = get<std::uint32_t>(file, at + 4);
      chunk.level = get<std::uint32_t>(file, at + 8);
      chunk.part = get<std::uint32_t>(file, at + 12);
      const std::byte* stored = file.data() + get<std::uint64_t>(file, at + 16);
      const auto size = static_cast<std::size_t>(get<std::uint64_t>(file, at + 24));
      chunk.content = chunk.flags & 2 ? zstdDecode(stored, size) : Bytes(stored, stored + size);
      chunks.push_back(chunk);
    }
    minor = get<std::uint16_t>(file, 14);
  }

  static std::uint32_t fourcc(std::string_view name) {
    std::uint32_t value = 0;
    std::memcpy(&value, name.data(), 4);
    return value;
  }

  // The first chunk of that name.
  std::size_t find(std::string_view name) const {
    std::size_t i = 0;
    while (i < chunks.size() && chunks[i].fourcc != fourcc(name)) ++i;
    EXPECT_LT(i, chunks.size()) << name;
    return i;
  }
  Bytes& content(std::string_view name) { return chunks[find(name)].content; }

  // Lets `edit` change the only page of the first level, below zstd if it is a frame, and states its new size
  // and checksum in the page table.
  template <class Edit>
  void editPage(Edit edit) {
    editPage(find("GRID"), edit);
  }
  // The same of another level, whose GRID is at this place.
  template <class Edit>
  void editPage(std::size_t grid, Edit edit) {
    Bytes& table = chunks[grid].content;
    Bytes& bricks = chunks[grid + 1].content;
    const std::size_t at = table.size() - 32;
    ASSERT_EQ(get<std::uint32_t>(table, at + 8), bricks.size()) << "more than one page";
    if (isFrame(bricks)) {
      Bytes page = zstdDecode(bricks.data(), bricks.size());
      edit(page);
      bricks = zstdFrame(page);
      set(table, at + 12, static_cast<std::uint32_t>(page.size()));
    } else {
      edit(bricks);
    }
    set(table, at + 8, static_cast<std::uint32_t>(bricks.size()));
    set(table, at + 16, static_cast<std::uint64_t>(XXH3_64bits(bricks.data(), bricks.size())));
  }

  Bytes build() const {
    Bytes file(64 + 48 * chunks.size());
    static constexpr unsigned char kIdentifier[12] = {0xAB, 'K',  'E',  'L',  'P',  'A',
                                                      'K',  0xBB, '\r', '\n', 0x1A, '\n'};
    std::memcpy(file.data(), kIdentifier, 12);
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const Chunk& chunk = chunks[i];
      const Bytes stored = chunk.flags & 2 ? zstdFrame(chunk.content) : chunk.content;
      file.resize((file.size() + 63) / 64 * 64 + chunk.gap);
      const std::size_t at = 64 + 48 * i;
      set(file, at, chunk.fourcc);
      set(file, at + 4, chunk.flags);
      set(file, at + 8, chunk.level);
      set(file, at + 12, chunk.part);
      set(file, at + 16, static_cast<std::uint64_t>(file.size() + chunk.offset_lie));
      set(file, at + 24, static_cast<std::uint64_t>(stored.size()));
      set(file, at + 32, static_cast<std::uint64_t>(chunk.raw_lie ? chunk.raw_lie : chunk.content.size()));
      set(file, at + 40, static_cast<std::uint64_t>(XXH3_64bits(stored.data(), stored.size())));
      file.insert(file.end(), stored.begin(), stored.end());
    }
    set(file, 12, major);
    set(file, 14, minor);
    set(file, 16, static_cast<std::uint64_t>(file.size()));
    set(file, 24, static_cast<std::uint32_t>(chunks.size()));
    set(file, 56, static_cast<std::uint64_t>(XXH3_64bits(file.data(), 64 + 48 * chunks.size())));
    return file;
  }
};

}  // namespace kelp::test

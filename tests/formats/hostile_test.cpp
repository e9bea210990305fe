// SPDX-License-Identifier: MIT
// Packs that lie: cut, changed, contradicting themselves with every checksum right, or asking for too much.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "kelp/formats/pack.h"
#include "kelp/formats/verify.h"
#include "pack_compare.h"
#include "pack_surgeon.h"
#include "short_memory.h"
#include "support/random_pack.h"
#include "tiny_fog_pack.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

using test::Bytes;
using test::PackSurgeon;
using test::set;

Bytes tinyBytes() {
  static const Bytes bytes = test::writeToMemory(test::makeTinyPack());
  return bytes;
}

struct Reading {
  std::optional<Error> error;
  bool equal = false;  // to the tiny pack
};

// Reads everything a pack has.
Reading readAll(const Source& source, const Limits& limits = {}, const Allocator& allocator = {}) {
  static const RawPack tiny = test::makeTinyPack();
  const Result<Pack> pack = Pack::open(source, limits, allocator);
  if (!pack) return {pack.error()};
  const test::Comparison result = test::compare(*pack, tiny);
  if (!result.status) return {result.status.error()};
  return {std::nullopt, result.equal};
}

Reading readAll(const Bytes& bytes, const Limits& limits = {}) {
  test::Bytes copy(bytes);  // a block of exactly this size, so that a sanitizer sees reads beyond it
  MemorySource memory(copy);
  return readAll(memory.source(), limits);
}

void expectError(const Bytes& bytes, ErrorCode code, const Limits& limits = {}) {
  const Reading reading = readAll(bytes, limits);
  ASSERT_TRUE(reading.error) << "accepted";
  EXPECT_EQ(toString(reading.error->code), toString(code)) << reading.error->detail;
  EXPECT_TRUE(reading.error->offset == Error::kNoOffset || reading.error->offset <= bytes.size());
}

TEST(Hostile, TheTinyPackItselfIsSound) {
  const Reading reading = readAll(tinyBytes());
  ASSERT_FALSE(reading.error) << reading.error->detail;
  EXPECT_TRUE(reading.equal);
  // And the surgeon, who shares no code with the library, puts it together so that it reads the same.
  const Reading again = readAll(PackSurgeon(tinyBytes()).build());
  ASSERT_FALSE(again.error) << again.error->detail;
  EXPECT_TRUE(again.equal);
}

TEST(Hostile, EveryTruncationIsRefused) {
  const Bytes bytes = tinyBytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SCOPED_TRACE(size);
    expectError(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)),
                size == 0 ? ErrorCode::kNotAPack : ErrorCode::kTruncated);
  }
}

TEST(Hostile, OneMoreByteIsRefused) {
  Bytes bytes = tinyBytes();
  bytes.push_back(std::byte{0});
  expectError(bytes, ErrorCode::kCorrupt);
}

TEST(Hostile, EveryChangedByteIsRefusedOrHarmless) {
  const Bytes bytes = tinyBytes();
  std::size_t harmless = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned change : {0x01u, 0x80u, 0xFFu}) {
      Bytes changed = bytes;
      changed[at] ^= static_cast<std::byte>(change);
      const Reading reading = readAll(changed);
      if (reading.error) continue;
      ASSERT_TRUE(reading.equal) << "byte " << at;
      ++harmless;
    }
  }
  // Only padding between chunks may change unseen, and only by the reader: `verify` sees that too.
  EXPECT_LT(harmless, 3 * 64 * PackSurgeon(bytes).chunks.size());
}

TEST(Hostile, AnotherKindOfFileIsNotAPack) {
  for (const char* text : {"<html>", "glTF binary", "#include", "\x89PNG\r\n\x1a\n", ""}) {
    const std::byte* bytes = reinterpret_cast<const std::byte*>(text);
    expectError(Bytes(bytes, bytes + std::strlen(text)), ErrorCode::kNotAPack);
  }
}

TEST(Hostile, NewerMinorIsReadNewerMajorIsNot) {
  PackSurgeon surgeon(tinyBytes());
  surgeon.minor = 7;
  Bytes bytes = surgeon.build();
  MemorySource memory(bytes);
  const Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  EXPECT_EQ(pack->minorVersion(), 7);
  EXPECT_TRUE(readAll(bytes).equal);
  surgeon.major = 2;
  expectError(surgeon.build(), ErrorCode::kUnsupportedVersion);
  surgeon.major = 0;
  expectError(surgeon.build(), ErrorCode::kCorrupt);
}

TEST(Hostile, UnknownChunksAreSkippedUnlessRequired) {
  for (std::size_t place = 0; place <= PackSurgeon(tinyBytes()).chunks.size(); ++place) {
    PackSurgeon surgeon(tinyBytes());
    PackSurgeon::Chunk chunk;
    chunk.fourcc = PackSurgeon::fourcc("XTRA");
    chunk.level = 77;
    chunk.part = 0xffffffff;
    chunk.flags = 0xfffffff0;
    chunk.content.resize(100, std::byte{1});
    surgeon.chunks.insert(surgeon.chunks.begin() + static_cast<std::ptrdiff_t>(place), chunk);
    const Reading reading = readAll(surgeon.build());
    ASSERT_FALSE(reading.error) << reading.error->detail;
    EXPECT_TRUE(reading.equal);
    surgeon.chunks[place].flags = 1;
    expectError(surgeon.build(), ErrorCode::kUnsupportedFeature);
  }
}

// A lie, and what the reader must answer.
struct Lie {
  const char* name;
  ErrorCode code;
  void (*tell)(PackSurgeon& s);
};

constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;
constexpr ErrorCode kFeature = ErrorCode::kUnsupportedFeature;

const Lie kIndexLies[] = {
    {"no chunks", kCorrupt, [](PackSurgeon& s) { s.chunks.clear(); }},
    {"flag unknown", kFeature, [](PackSurgeon& s) { s.chunks[s.find("PART")].flags |= 4; }},
    {"PART not required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("PART")].flags &= ~1u; }},
    {"CLIP required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("CLIP")].flags |= 1u; }},
    {"metadata with level", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("MATL")].level = 1; }},
    {"metadata with part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("MATL")].part = 1; }},
    {"raw is not stored", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("BRCK")].raw_lie = 5; }},
    {"raw is not that of the frame", kCorrupt,
     [](PackSurgeon& s) {
       s.chunks[s.find("PART")].flags |= 2;
       s.chunks[s.find("PART")].raw_lie = s.content("PART").size() + 1;
     }},
    {"expands beyond zstd", kCorrupt,
     [](PackSurgeon& s) {
       s.chunks[s.find("PART")].flags |= 2;
       s.chunks[s.find("PART")].raw_lie = std::uint64_t{1} << 31;
     }},
    {"BRCK compressed in one", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("BRCK")].flags |= 2; }},
    {"offset too large", kCorrupt, [](PackSurgeon& s) { s.chunks[2].offset_lie = 64; }},
    {"offset wraps around", kCorrupt, [](PackSurgeon& s) { s.chunks[2].offset_lie = ~std::uint64_t{0} - 63; }},
    {"64 zeros too many", kCorrupt, [](PackSurgeon& s) { s.chunks[2].gap = 64; }},
    {"not aligned", kCorrupt, [](PackSurgeon& s) { s.chunks.back().gap = 8; }},
    {"PART missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("PART"))); }},
    {"MATL missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("MATL"))); }},
    {"RIGS missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("RIGS"))); }},
    {"GRID missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("GRID"))); }},
    {"BRCK missing", kCorrupt, [](PackSurgeon& s) { s.chunks.pop_back(); }},
    {"PART twice", kCorrupt, [](PackSurgeon& s) { s.chunks.insert(s.chunks.begin(), s.chunks[s.find("PART")]); }},
    {"MATL before PART", kCorrupt, [](PackSurgeon& s) { std::swap(s.chunks[s.find("PART")], s.chunks[s.find("MATL")]); }},
    {"CLIP last", kCorrupt,
     [](PackSurgeon& s) {
       std::rotate(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("CLIP")),
                   s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("CLIP")) + 1, s.chunks.end());
     }},
    {"fine before coarse", kCorrupt,
     [](PackSurgeon& s) {
       const auto first = s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("GRID"));
       std::rotate(first, first + 2, first + 4);
     }},
    {"BRCK before GRID", kCorrupt, [](PackSurgeon& s) { std::swap(s.chunks[s.find("GRID")], s.chunks[s.find("BRCK")]); }},
    {"one level too many", kCorrupt, [](PackSurgeon& s) { s.chunks.push_back(s.chunks[s.find("GRID")]); }},
    {"level of another part", kCorrupt, [](PackSurgeon& s) { s.chunks.back().part = 0; }},
};

const Lie kPartLies[] = {
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("PART").resize(7); }},
    {"no parts", kCorrupt, [](PackSurgeon& s) { s.content("PART").assign(8, std::byte{0}); }},
    {"count of 2^32 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 0, 0xffffffffu); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("PART").push_back(std::byte{'x'}); }},
    {"name beyond the text", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 128, 7u); }},
    {"name of 2^32 - 1 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 128, 0xffffffffu); }},
    {"text left over", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 128, 5u); }},
    {"name splits a character", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("PART"), 8, 7u);
       set(s.content("PART"), 128, 3u);
     }},
    {"name with newline", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, '\n'); }},
    {"name with escape", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, '\x1b'); }},
    {"name with C1 control", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, std::uint16_t{0x9bc2}); }},
    {"name overlong", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, std::uint16_t{0xafc0}); }},
    {"name with surrogate", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("PART"), 249, std::uint16_t{0xa0ed});
       set(s.content("PART"), 251, std::uint8_t{0x80});
     }},
    {"parent is itself", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 132, std::int32_t{1}); }},
    {"parent of the first", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 12, std::int32_t{0}); }},
    {"parent -2", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 12, std::int32_t{-2}); }},
    {"fog without its table", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 16, std::uint8_t{1}); }},
    {"kind 200", kFeature, [](PackSurgeon& s) { set(s.content("PART"), 16, std::uint8_t{200}); }},
    {"0 levels", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 17, std::uint8_t{0}); }},
    {"17 levels", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 17, std::uint8_t{17}); }},
    {"16 levels", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 17, std::uint8_t{16}); }},
    {"reserved", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 18, std::uint16_t{1}); }},
    {"size 0", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 20, 0u); }},
    {"size -1", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 24, 0xffffffffu); }},
    {"size 32769", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 28, 32769u); }},
    {"size 9000", ErrorCode::kLimit, [](PackSurgeon& s) { set(s.content("PART"), 28, 9000u); }},
    {"size is another", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 28, 9u); }},
    {"transform not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 32 + 44, test::kNan); }},
    {"transform flat", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 32, 0.0f); }},
    {"pivot not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 80 + 4, test::kInfinity); }},
    {"info not UTF-8", kCorrupt, [](PackSurgeon& s) { set(s.content("INFO"), 0, '\xff'); }},
    {"info with null", kCorrupt, [](PackSurgeon& s) { set(s.content("INFO"), 0, '\0'); }},
};

const Lie kPaletteAndRigLies[] = {
    {"palette too short", kCorrupt, [](PackSurgeon& s) { s.content("MATL").resize(3); }},
    {"no colours", kCorrupt, [](PackSurgeon& s) { s.content("MATL").assign(4, std::byte{0}); }},
    {"257 colours", kCorrupt,
     [](PackSurgeon& s) {
       s.content("MATL").assign(4 + 257 * 36, std::byte{0});
       set(s.content("MATL"), 0, 257u);
     }},
    {"2^32 - 1 colours", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 0, 0xffffffffu); }},
    {"palette one byte more", kCorrupt, [](PackSurgeon& s) { s.content("MATL").push_back(std::byte{0}); }},
    {"colour above 1", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 4, 1.5f); }},
    {"colour not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 16, test::kNan); }},
    {"negative light", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 20, -1.0f); }},
    {"endless light", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 28, test::kInfinity); }},
    {"metallic 2", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 32, 2.0f); }},
    {"roughness -1", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 36, -1.0f); }},
    {"rigs too short", kCorrupt, [](PackSurgeon& s) { s.content("RIGS").resize(15); }},
    {"rigs of 3 parts", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 0, 3u); }},
    {"2^32 - 1 knots", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 4, 0xffffffffu); }},
    {"rig of 1 knot", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("RIGS"), 8, 4u);
       set(s.content("RIGS"), 12, 1u);
     }},
    {"rig beyond the table", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 12, 3u); }},
    {"knots left over", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 8, 2u); }},
    {"first knot not at 0", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 16, 0.1f); }},
    {"knot not ascending", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 16 + 28, 0.0f); }},
    {"knot not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 16 + 4, test::kInfinity); }},
    {"spline turns back", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 16 + 20, -20.0f); }},
};

const Lie kClipLies[] = {
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("CLIP").resize(19); }},
    {"counts of 2^32 - 1", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t at = 0; at < 20; at += 4) set(s.content("CLIP"), at, 0xffffffffu);
     }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("CLIP").push_back(std::byte{0}); }},
    {"name too long", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 20, 5u); }},
    {"name left over", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 20, 3u); }},
    {"name with control", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 256, '\x07'); }},
    {"duration 0", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 24, 0.0f); }},
    {"duration not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 24, test::kNan); }},
    {"2 waves of 1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 28, 2u); }},
    {"0 waves of 1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 28, 0u); }},
    {"3 tracks of 2", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 32, 3u); }},
    {"wave of part 2", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 36, 2u); }},
    {"wave of knot 3", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 40, 3u); }},
    {"wave of a part", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 44, 2u); }},
    {"wave target 2^31", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 44, 0x80000000u); }},
    {"amplitude not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 52, test::kInfinity); }},
    {"period 0", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 60, 0.0f); }},
    {"period -1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 60, -1.0f); }},
    {"phase not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 64, test::kNan); }},
    {"track of part 2", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 68, 2u); }},
    {"track of a part with a knot", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 72, 1u); }},
    {"track target 5", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 76, std::uint8_t{5}); }},
    {"interpolation 3", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 77, std::uint8_t{3}); }},
    {"reserved", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 78, std::uint16_t{1}); }},
    {"no keys", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 80, 0u); }},
    {"3 keys of 3, and 1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 80, 3u); }},
    {"keys left over", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 80, 1u); }},
    {"negative time", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 100, -1.0f); }},
    {"times descend", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 100, 2.0f); }},
    {"times equal", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 100, 1.5f); }},
    {"rotation not a unit", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 116, 1.1f); }},
    {"rotation not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 104, test::kNan); }},
    {"slope of a linear track", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 120, 1.0f); }},
    {"fourth component of an offset", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 204 + 16, 1.0f); }},
    {"fourth component of a slope", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 204 + 48, 1.0f); }},
    {"slope not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 204 + 36, test::kInfinity); }},
};

// The first grid is level 1 of part 0: two cells, the first solid; its page table begins at 8. The second has three cells and
// padding.
const Lie kGridLies[] = {
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("GRID").resize(4); }},
    {"no pages", kCorrupt, [](PackSurgeon& s) { s.content("GRID").resize(8); }},
    {"half a page entry", kCorrupt, [](PackSurgeon& s) { s.content("GRID").resize(24); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("GRID").push_back(std::byte{0}); }},
    {"padding not zero", kCorrupt, [](PackSurgeon& s) { set(s.chunks[s.find("GRID") + 2].content, 12, 1u); }},
    {"reserved bits of a cell", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 0, 0x81000000u); }},
    {"slot 1 without 0", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 0, 0x80000001u); }},
    {"slot twice", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 4, 0x80000000u); }},
    {"slots out of order", kCorrupt,
     [](PackSurgeon& s) {
       set(s.chunks[s.find("GRID") + 2].content, 0, 0x80000001u);
       set(s.chunks[s.find("GRID") + 2].content, 8, 0x80000000u);
     }},
    {"a brick too many", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 4, 0x80000001u); }},
    {"no brick", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 0, 0u); }},
    {"page not at 0", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 8, std::uint64_t{1}); }},
    {"page at 2^64 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 8, ~std::uint64_t{0}); }},
    {"page shorter than its chunk", kCorrupt,
     [](PackSurgeon& s) { set(s.content("GRID"), 16, static_cast<std::uint32_t>(s.content("BRCK").size() - 1)); }},
    {"page longer than its chunk", kCorrupt,
     [](PackSurgeon& s) { set(s.content("GRID"), 16, static_cast<std::uint32_t>(s.content("BRCK").size() + 1)); }},
    {"page of 0 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 16, 0u); }},
    {"page expands to 2^32 - 4", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 0xfffffffcu); }},
    {"page of another size", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 520u); }},
    {"page of odd size", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 517u); }},
    {"page too small for its brick", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 508u); }},
    {"page checksum", ErrorCode::kChecksum, [](PackSurgeon& s) { set(s.content("GRID"), 24, std::uint64_t{1}); }},
    {"first slot 1", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 32, 1u); }},
    {"page of no bricks", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 0u); }},
    {"page of 2^32 - 1 bricks", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 0xffffffffu); }},
    {"page of a brick too few", kCorrupt, [](PackSurgeon& s) { set(s.chunks[s.find("GRID") + 2].content, 16 + 28, 1u); }},
};

// Byte 0 of the page is a surface voxel, byte 1 an inner one; the attribute follows the 512 codes.
const Lie kPageLies[] = {
    {"reserved code", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[100] = std::byte{129}; }); }},
    {"a rank", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[0] = std::byte{65}; }); }},
    {"reserved code 192", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[0] = std::byte{192}; }); }},
    {"attribute missing", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p.resize(512); }); }},
    {"attribute too many", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p.resize(520); }); }},
    {"surface voxel without attribute", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[64] = std::byte{64}; }); }},
    {"palette index 2 of 2", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[512] = std::byte{2}; }); }},
    {"nothing solid", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p.assign(512, std::byte{0}); }); }},
    {"not a zstd frame", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& bricks = s.content("BRCK");
       bricks[0] ^= std::byte{1};
       set(s.content("GRID"), 24, static_cast<std::uint64_t>(XXH3_64bits(bricks.data(), bricks.size())));
     }},
    {"bytes after the frame", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& bricks = s.content("BRCK");
       bricks.push_back(std::byte{0});
       set(s.content("GRID"), 16, static_cast<std::uint32_t>(bricks.size()));
       set(s.content("GRID"), 24, static_cast<std::uint64_t>(XXH3_64bits(bricks.data(), bricks.size())));
     }},
    {"skippable frame after the frame", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& bricks = s.content("BRCK");
       for (const int byte : {0x50, 0x2A, 0x4D, 0x18, 0, 0, 0, 0}) bricks.push_back(static_cast<std::byte>(byte));
       set(s.content("GRID"), 16, static_cast<std::uint32_t>(bricks.size()));
       set(s.content("GRID"), 24, static_cast<std::uint64_t>(XXH3_64bits(bricks.data(), bricks.size())));
     }},
    {"two frames", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& bricks = s.content("BRCK");
       const Bytes page = test::zstdDecode(bricks.data(), bricks.size());
       bricks = test::zstdFrame(Bytes(page.begin(), page.begin() + 256));
       const Bytes second = test::zstdFrame(Bytes(page.begin() + 256, page.end()));
       bricks.insert(bricks.end(), second.begin(), second.end());
       set(s.content("GRID"), 16, static_cast<std::uint32_t>(bricks.size()));
       set(s.content("GRID"), 24, static_cast<std::uint64_t>(XXH3_64bits(bricks.data(), bricks.size())));
     }},
};

template <std::size_t N>
void expectAllRefused(const Lie (&lies)[N]) {
  for (const Lie& lie : lies) {
    SCOPED_TRACE(lie.name);
    PackSurgeon surgeon(tinyBytes());
    lie.tell(surgeon);
    expectError(surgeon.build(), lie.code);
  }
}

TEST(Hostile, LiesInTheIndexAreRefused) { expectAllRefused(kIndexLies); }
TEST(Hostile, LiesInThePartsAreRefused) { expectAllRefused(kPartLies); }
TEST(Hostile, LiesInPaletteAndRigsAreRefused) { expectAllRefused(kPaletteAndRigLies); }
TEST(Hostile, LiesInTheClipsAreRefused) { expectAllRefused(kClipLies); }
TEST(Hostile, LiesInGridsAreRefused) { expectAllRefused(kGridLies); }
TEST(Hostile, LiesInPagesAreRefused) { expectAllRefused(kPageLies); }

TEST(Hostile, LimitsAreObeyed) {
  Limits limits;
  limits.max_side = 23;  // the stem is 24 high
  expectError(tinyBytes(), ErrorCode::kLimit, limits);
  limits = {};
  limits.max_parts = 1;
  expectError(tinyBytes(), ErrorCode::kLimit, limits);
  limits = {};
  limits.max_decoded_bytes = 100;
  expectError(tinyBytes(), ErrorCode::kLimit, limits);
  limits = {2000, 24, 2};
  EXPECT_TRUE(readAll(tinyBytes(), limits).equal);
  // The metadata together: first as they are decoded, then as tables. Every byte less than they take is refused.
  std::uint64_t least = 1;
  for (limits.max_metadata_bytes = 1; !readAll(tinyBytes(), limits).equal; least = ++limits.max_metadata_bytes) {
    ASSERT_LT(limits.max_metadata_bytes, 10000u);
    expectError(tinyBytes(), ErrorCode::kLimit, limits);
  }
  std::uint64_t decoded = 0;
  for (PackSurgeon surgeon(tinyBytes()); const char* name : {"INFO", "PART", "MATL", "RIGS", "CLIP"}) decoded += surgeon.content(name).size();
  EXPECT_GE(least, decoded);
  EXPECT_LE(least, 3 * decoded);
}

// Everything of a pack, read and verified, with the given allocator throughout.
Result<void> readThroughout(const Source& source, const RawPack& raw, const Allocator& allocator) {
  const Result<Pack> pack = Pack::open(source, {}, allocator);
  if (!pack) return pack.error();
  const test::Comparison all = test::compare(*pack, raw, allocator);
  EXPECT_TRUE(!all.status || all.equal);
  return all.status;
}

// Each request refused, alone or with all that follow.
void expectFailedAllocationsReported(const RawPack& raw) {
  PackSurgeon surgeon(test::writeToMemory(raw));
  for (PackSurgeon::Chunk& chunk : surgeon.chunks)
    if (chunk.fourcc != PackSurgeon::fourcc("BRCK") && chunk.fourcc != PackSurgeon::fourcc("FOGB")) chunk.flags |= 2;  // the longer way
  const Bytes bytes = surgeon.build();
  MemorySource memory(bytes);
  const auto issue = [](void* user, const Issue& found) { *static_cast<ErrorCode*>(user) = found.error.code; };
  test::ShortMemory enough, enough_to_verify;
  ASSERT_TRUE(readThroughout(memory.source(), raw, enough.allocator()));
  ASSERT_EQ(verify(memory.source(), {}, nullptr, nullptr, enough_to_verify.allocator()), 0u);
  EXPECT_EQ(enough.live, 0u);
  EXPECT_EQ(enough_to_verify.live, 0u);
  EXPECT_GT(enough.requests, 20u);
  EXPECT_GT(enough_to_verify.requests, 20u);
  for (const bool and_on : {true, false}) {
    for (std::size_t n = 0; n < enough.requests; ++n) {
      test::ShortMemory short_memory{n, and_on};
      const Result<void> result = readThroughout(memory.source(), raw, short_memory.allocator());
      ASSERT_FALSE(result) << n;
      EXPECT_EQ(result.error().code, ErrorCode::kOutOfMemory) << n;
      EXPECT_EQ(short_memory.live, 0u) << n;
    }
    for (std::size_t n = 0; n < enough_to_verify.requests; ++n) {
      test::ShortMemory short_memory{n, and_on};
      ErrorCode last = ErrorCode::kMisuse;
      EXPECT_GT(verify(memory.source(), {}, issue, &last, short_memory.allocator()), 0u) << n;
      EXPECT_EQ(last, ErrorCode::kOutOfMemory) << n;
      EXPECT_EQ(short_memory.live, 0u) << n;
    }
  }
}

TEST(Hostile, EveryFailedAllocationIsReportedAndNothingLeaks) {
  expectFailedAllocationsReported(test::makeTinyPack());
  expectFailedAllocationsReported(test::makeTinyFogPack());
}

TEST(Hostile, AllocatorsLackNothing) {
  const Bytes bytes = tinyBytes();
  MemorySource memory(bytes);
  Allocator half;
  half.deallocate = nullptr;
  EXPECT_EQ(Pack::open(memory.source(), {}, half).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(verify(memory.source(), {}, nullptr, nullptr, half), 1u);
}

TEST(Hostile, ClaimsOfSizeAreNotBelievedBeforeMemoryIsTaken) {
  // Each claims gigabytes; none may cost more than a little of them.
  const auto peak = [](void (*tell)(PackSurgeon&)) {
    PackSurgeon surgeon(tinyBytes());
    tell(surgeon);
    const Bytes bytes = surgeon.build();
    MemorySource memory(bytes);
    test::ShortMemory counter;
    EXPECT_FALSE(readThroughout(memory.source(), test::makeTinyPack(), counter.allocator()));
    EXPECT_LE(counter.peak_bytes, test::mostMemory({}, bytes.size()));
    return counter.peak_bytes;
  };
  EXPECT_LT(peak([](PackSurgeon& s) { set(s.content("PART"), 0, 0xffffffffu); }), 100000u);
  EXPECT_LT(peak([](PackSurgeon& s) {
              for (const std::size_t at : {20u, 24u, 28u}) set(s.content("PART"), at, 8192u);
            }),
            300000u);
  EXPECT_LT(peak([](PackSurgeon& s) {
              s.chunks[s.find("MATL")].flags |= 2;
              s.chunks[s.find("MATL")].raw_lie = std::uint64_t{3} << 30;
            }),
            100000u);
  EXPECT_LT(peak([](PackSurgeon& s) { set(s.content("CLIP"), 12, 0xffffffffu); }), 300000u);
  // These are as large as they claim, though not in the file: a million of the same wave, two million empty entries for pages.
  EXPECT_LT(peak([](PackSurgeon& s) {
              Bytes& clips = s.content("CLIP");
              constexpr std::uint32_t kWaves = 1000000;
              clips.assign(20 + 16 + std::size_t{kWaves} * 32, std::byte{0});
              set(clips, 0, 1u);
              set(clips, 4, kWaves);
              set(clips, 24, 1.0f);
              set(clips, 28, kWaves);
              for (std::size_t at = 36; at < clips.size(); at += 32) set(clips, at + 24, 1.0f);
              s.chunks[s.find("CLIP")].flags |= 2;
            }),
            50000000u);
  EXPECT_LT(peak([](PackSurgeon& s) {
              s.content("GRID").resize(s.content("GRID").size() + 64000000);
              s.chunks[s.find("GRID")].flags |= 2;
            }),
            300000u);
}

TEST(Hostile, ReadingPageAfterPageAllocatesNothing) {
  test::RandomPack random(21, {1, 8, 1, 0});
  RawPack raw = random.make();
  raw.parts[0].size = {100, 100, 100};
  raw.parts[0].knots = {{0, {0, 0, 0}, {0, 100, 0}}, {1, {0, 100, 0}, {0, 100, 0}}};
  raw.parts[0].levels = {random.makeLevel(raw.parts[0].size, raw.palette.size(), 0.5f)};
  const Bytes bytes = test::writeToMemory(raw);
  MemorySource memory(bytes);
  Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  const Result<LevelGrid> grid = pack->readGrid(0, 0);
  ASSERT_TRUE(grid);
  ASSERT_GT(grid->pages.size(), 5u);
  test::ShortMemory counter;
  PageData page(counter.allocator());
  for (const PageInfo& info : grid->pages) ASSERT_TRUE(pack->readPage(info, page));
  const std::size_t first_round = counter.requests;
  for (const PageInfo& info : grid->pages) ASSERT_TRUE(pack->readPage(info, page));
  EXPECT_EQ(counter.requests, first_round);
}

TEST(Hostile, EveryFailedReadIsReported) {
  const Bytes bytes = tinyBytes();
  struct Unreliable {
    MemorySource memory;
    std::size_t reads = 0, fail_at = std::numeric_limits<std::size_t>::max();
  };
  const auto read = [](Unreliable& unreliable) {
    Source source;
    source.user = &unreliable;
    source.size = unreliable.memory.source().size;
    source.read = [](void* user, std::uint64_t offset, std::span<std::byte> into) {
      Unreliable& self = *static_cast<Unreliable*>(user);
      if (self.reads++ == self.fail_at) return false;
      const Source all = self.memory.source();
      EXPECT_LE(offset + into.size(), all.size);
      return all.read(all.user, offset, into);
    };
    return readAll(source);
  };
  Unreliable reliable{MemorySource(bytes)};
  ASSERT_TRUE(read(reliable).equal);
  for (std::size_t n = 0; n < reliable.reads; ++n) {
    Unreliable unreliable{MemorySource(bytes), 0, n};
    const Reading reading = read(unreliable);
    ASSERT_TRUE(reading.error) << n;
    EXPECT_EQ(reading.error->code, ErrorCode::kIo) << n;
  }
}

}  // namespace
}  // namespace kelp

// SPDX-License-Identifier: MIT
// Packs that are cut or changed, from another time, or asking for too much; reads and allocations that fail.
// Tables that contradict themselves: hostile_lies_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "kelp/formats/level.h"
#include "kelp/formats/verify.h"
#include "lying_pack.h"
#include "support/short_memory.h"
#include "tiny_cage_pack.h"
#include "tiny_fog_pack.h"

namespace kelp {
namespace {

using test::Bytes;
using test::PackSurgeon;
using test::Reading;
using test::set;
using test::tinyBytes;

Reading readTiny(const Bytes& bytes, const PackLimits& limits = {}) {
  return test::readAll(test::tinyPack(), bytes, limits);
}

void expectError(const Bytes& bytes, ErrorCode code, const PackLimits& limits = {}) {
  test::expectRefused(readTiny(bytes, limits), bytes, code);
}

TEST(Hostile, TheTinyPackItselfIsSound) {
  const Reading reading = readTiny(tinyBytes());
  ASSERT_FALSE(reading.error) << reading.error->detail;
  EXPECT_TRUE(reading.equal);
  // And the surgeon, who shares no code with the library, puts it together so that it reads the same.
  const Reading again = readTiny(PackSurgeon(tinyBytes()).build());
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
      const Reading reading = readTiny(changed);
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
  EXPECT_TRUE(readTiny(bytes).equal);
  surgeon.major = 2;
  expectError(surgeon.build(), ErrorCode::kUnsupportedVersion);
  surgeon.major = 0;
  expectError(surgeon.build(), ErrorCode::kUnsupportedVersion);
}

TEST(Hostile, EmptyPartsHaveNoLevelsAndNotAllPartsAreEmpty) {
  constexpr std::size_t kKind = 8 + 8, kLevels = 8 + 9, kSize = 8 + 12;  // of the first part
  const PackSurgeon sound(test::writeToMemory(test::makeTinyEmptyPack()));
  const auto lie = [&](std::size_t at, auto value) {
    PackSurgeon surgeon = sound;
    test::set(surgeon.content("PART"), at, value);
    return surgeon.build();
  };
  expectError(lie(kKind, std::uint8_t{3}), ErrorCode::kUnsupportedFeature);
  expectError(lie(kKind, std::uint8_t{0}), ErrorCode::kCorrupt);
  expectError(lie(kLevels, std::uint8_t{1}), ErrorCode::kCorrupt);
  expectError(lie(kSize, 0u), ErrorCode::kCorrupt);
  expectError(lie(kSize, 8193u), ErrorCode::kLimit);
  expectError(lie(kSize, 32769u), ErrorCode::kCorrupt);
  RawPack all = test::makeTinyEmptyPack();
  for (RawPart& part : all.parts) part.levels.clear();
  std::vector<std::byte> none;
  const Result<void> written = writePack(all, Sink::into(none));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kMisuse);
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
    const Reading reading = readTiny(surgeon.build());
    ASSERT_FALSE(reading.error) << reading.error->detail;
    EXPECT_TRUE(reading.equal);
    surgeon.chunks[place].flags = 1;
    expectError(surgeon.build(), ErrorCode::kUnsupportedFeature);
  }
}

TEST(Hostile, LimitsAreObeyed) {
  PackLimits limits;
  limits.max_side = 23;  // the stem is 24 high
  expectError(tinyBytes(), ErrorCode::kLimit, limits);
  limits = {};
  limits.max_parts = 1;
  expectError(tinyBytes(), ErrorCode::kLimit, limits);
  limits = {};
  limits.max_decoded_bytes = 100;
  expectError(tinyBytes(), ErrorCode::kLimit, limits);
  limits = {2000, 24, 2};
  EXPECT_TRUE(readTiny(tinyBytes(), limits).equal);
  // The metadata together: first as they are decoded, then as tables. Every byte less than they take is
  // refused.
  std::uint64_t least = 1;
  for (limits.max_metadata_bytes = 1; !readTiny(tinyBytes(), limits).equal;
       least = ++limits.max_metadata_bytes) {
    ASSERT_LT(limits.max_metadata_bytes, 10000u);
    expectError(tinyBytes(), ErrorCode::kLimit, limits);
  }
  std::uint64_t decoded = 0;
  for (PackSurgeon surgeon(tinyBytes()); const char* name : {"INFO", "PART", "MATL", "RIGS", "CLIP"})
    decoded += surgeon.content(name).size();
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
    // the longer way
    if (chunk.fourcc != PackSurgeon::fourcc("BRCK") && chunk.fourcc != PackSurgeon::fourcc("FOGB"))
      chunk.flags |= 2;
  const Bytes bytes = surgeon.build();
  MemorySource memory(bytes);
  const auto issue = [](void* user, const Issue& found) {
    *static_cast<ErrorCode*>(user) = found.error.code;
  };
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
  expectFailedAllocationsReported(test::makeTinyJointPack());
  expectFailedAllocationsReported(test::makeTinyCagePack());
  expectFailedAllocationsReported(test::makeTinyMorphPack());
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
  // These are as large as they claim, though not in the file: a million of the same wave, two million empty
  // entries for pages.
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
  raw.parts[0].knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
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
  for (std::size_t i = 0; i < grid->pages.size(); ++i) ASSERT_TRUE(pack->readPage(*grid, i, {}, page));
  const std::size_t first_round = counter.requests;
  for (std::size_t i = 0; i < grid->pages.size(); ++i) ASSERT_TRUE(pack->readPage(*grid, i, {}, page));
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
      if (self.reads++ == self.fail_at) return Read::kFailed;
      const Source all = self.memory.source();
      EXPECT_LE(offset + into.size(), all.size);
      return all.read(all.user, offset, into);
    };
    return test::readAll(test::tinyPack(), source);
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

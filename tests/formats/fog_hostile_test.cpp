// SPDX-License-Identifier: MIT
// Packs of fog that lie: with every checksum right, what the reader refuses, and what verify says of it.
#include <gtest/gtest.h>

#include <algorithm>

#include "kelp/formats/pack.h"
#include "kelp/formats/verify.h"
#include "lying_pack.h"
#include "tiny_fog_pack.h"

namespace kelp {
namespace {

using test::Bytes;
using test::kCorrupt;
using test::Lie;
using test::PackSurgeon;
using test::Reading;
using test::set;

const RawPack& fogPack() {
  static const RawPack pack = test::makeTinyFogPack();
  return pack;
}

const Bytes& fogBytes() {
  static const Bytes bytes = test::writeToMemory(fogPack());
  return bytes;
}

Reading readFog(const Bytes& bytes, const PackLimits& limits = {}) {
  return test::readAll(fogPack(), bytes, limits);
}

std::vector<Issue> fogIssuesOf(const Bytes& bytes) {
  std::vector<Issue> issues;
  MemorySource memory(bytes);
  verify(
      memory.source(), {},
      [](void* user, const Issue& issue) { static_cast<std::vector<Issue>*>(user)->push_back(issue); },
      &issues);
  return issues;
}

// Whatever the reader refuses, verify must find too.
template <std::size_t N>
void expectFogRefused(const Lie (&lies)[N], const Bytes& bytes = fogBytes()) {
  for (const Lie& lie : lies) {
    SCOPED_TRACE(lie.name);
    PackSurgeon surgeon(bytes);
    lie.tell(surgeon);
    const Bytes told = surgeon.build();
    test::expectRefused(readFog(told), told, lie.code);
    const std::vector<Issue> issues = fogIssuesOf(told);
    EXPECT_TRUE(std::any_of(issues.begin(), issues.end(),
                            [](const Issue& issue) { return issue.severity == Severity::kError; }));
  }
}

// Chunks: INFO PART MATL FOGS RIGS, no CLIP; then a GRID and its bricks of smoke 1, stone 0, smoke 0, flame
// 0.
std::size_t flameGrid(const PackSurgeon& s) { return s.chunks.size() - 2; }

void takeOut(PackSurgeon& s, std::string_view name) {
  s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find(name)));
}

const Lie kFogIndexLies[] = {
    {"FOGS missing", kCorrupt, [](PackSurgeon& s) { takeOut(s, "FOGS"); }},
    {"FOGS twice", kCorrupt,
     [](PackSurgeon& s) {
       s.chunks.insert(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("FOGS")),
                       s.chunks[s.find("FOGS")]);
     }},
    {"FOGS before MATL", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("FOGS")], s.chunks[s.find("MATL")]); }},
    {"FOGS after RIGS", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("FOGS")], s.chunks[s.find("RIGS")]); }},
    {"FOGS last", kCorrupt,
     [](PackSurgeon& s) {
       const auto fogs = s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("FOGS"));
       std::rotate(fogs, fogs + 1, s.chunks.end());
     }},
    {"FOGS not required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("FOGS")].flags &= ~1u; }},
    {"FOGS with level", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("FOGS")].level = 1; }},
    {"FOGS with part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("FOGS")].part = 1; }},
    {"FOGB missing", kCorrupt, [](PackSurgeon& s) { takeOut(s, "FOGB"); }},
    {"FOGB twice", kCorrupt, [](PackSurgeon& s) { s.chunks.push_back(s.chunks.back()); }},
    {"FOGB before GRID", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("GRID")], s.chunks[s.find("FOGB")]); }},
    {"FOGB not required", kCorrupt, [](PackSurgeon& s) { s.chunks.back().flags &= ~1u; }},
    {"FOGB compressed in one", kCorrupt, [](PackSurgeon& s) { s.chunks.back().flags |= 2; }},
    {"FOGB of another level", kCorrupt, [](PackSurgeon& s) { s.chunks.back().level = 1; }},
    {"FOGB of another part", kCorrupt, [](PackSurgeon& s) { s.chunks.back().part = 1; }},
    {"FOGB of another raw size", kCorrupt, [](PackSurgeon& s) { s.chunks.back().raw_lie = 729; }},
    {"BRCK where FOGB belongs", kCorrupt,
     [](PackSurgeon& s) { s.chunks[s.find("FOGB")].fourcc = PackSurgeon::fourcc("BRCK"); }},
    {"FOGB where BRCK belongs", kCorrupt,
     [](PackSurgeon& s) { s.chunks[s.find("BRCK")].fourcc = PackSurgeon::fourcc("FOGB"); }},
    {"smoke said to be solid", kCorrupt,
     [](PackSurgeon& s) { set(s.content("PART"), 8 + 120 + 8, std::uint8_t{0}); }},
    {"stone said to be fog", kCorrupt,
     [](PackSurgeon& s) { set(s.content("PART"), 8 + 8, std::uint8_t{1}); }},
    {"kind 2", ErrorCode::kUnsupportedFeature,
     [](PackSurgeon& s) { set(s.content("PART"), 8 + 8, std::uint8_t{3}); }},
};

// Two records of 28 bytes at 4 and 32, the extinctions of smoke 0, smoke 1, flame 0 at 60, the two colors of
// flame's ramp at 72.
const Lie kFogTableLies[] = {
    {"too short for a count", kCorrupt, [](PackSurgeon& s) { s.content("FOGS").resize(3); }},
    {"count 0", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 0, 0u); }},
    {"count 1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 0, 1u); }},
    {"count 3", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 0, 3u); }},
    {"count 2^32 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 0, 0xffffffffu); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("FOGS").push_back(std::byte{0}); }},
    {"one byte fewer", kCorrupt, [](PackSurgeon& s) { s.content("FOGS").pop_back(); }},
    {"a color more", kCorrupt, [](PackSurgeon& s) { s.content("FOGS").resize(96 + 12); }},
    {"a color fewer", kCorrupt, [](PackSurgeon& s) { s.content("FOGS").resize(96 - 12); }},
    {"no extinctions", kCorrupt, [](PackSurgeon& s) { s.content("FOGS").resize(60); }},
    {"color above 1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 4, 1.5f); }},
    {"color below 0", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 8, -0.1f); }},
    {"color not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 40, test::kNan); }},
    {"anisotropy 1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 16, 1.0f); }},
    {"anisotropy -1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 16, -1.0f); }},
    {"anisotropy not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 44, test::kNan); }},
    {"glow below 0", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 20, -1.0f); }},
    {"glow not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 20, test::kNan); }},
    {"glow infinite", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 48, test::kInfinity); }},
    {"ramp of 1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 52, 1u); }},
    {"ramp of 1 and 1", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("FOGS"), 24, 1u);
       set(s.content("FOGS"), 52, 1u);
     }},
    {"ramp of 3", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 52, 3u); }},
    {"ramp of 257", kCorrupt,
     [](PackSurgeon& s) {
       s.content("FOGS").resize(72 + 257 * 12);
       set(s.content("FOGS"), 52, 257u);
     }},
    {"ramp of 2^32 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 24, 0xffffffffu); }},
    {"ramp of none", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 52, 0u); }},
    // The table is whole, but pages now have a channel too many, or too few.
    {"ramp of another part", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("FOGS"), 24, 2u);
       set(s.content("FOGS"), 52, 0u);
     }},
    {"no part has a ramp", kCorrupt,
     [](PackSurgeon& s) {
       s.content("FOGS").resize(72);
       set(s.content("FOGS"), 52, 0u);
     }},
    {"reserved", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 28, 1u); }},
    {"reserved of the second", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 56, 0x80000000u); }},
    {"extinction 0", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 60, 0.0f); }},
    {"extinction below 0", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 64, -1.0f); }},
    {"extinction not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 68, test::kNan); }},
    {"extinction infinite", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 68, test::kInfinity); }},
    {"ramp below 0", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 72, -1.0f); }},
    {"ramp not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 84, test::kNan); }},
    {"ramp infinite", kCorrupt, [](PackSurgeon& s) { set(s.content("FOGS"), 92, test::kInfinity); }},
};

// Smoke 1 has two cells and one page of two bricks; its raw size is at 8 + 12, its number of bricks at 8
// + 28.
const Lie kFogLevelLies[] = {
    {"a brick fewer", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[1] = std::byte{0}; }},
    {"a brick inside", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[1] = std::byte{129}; }},
    {"a cell's byte is 130", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[0] = std::byte{130}; }},
    {"a grid over voxels instead of cubes", kCorrupt,
     [](PackSurgeon& s) { set(s.content("PART"), 8 + 120 + 12, 36u); }},
    {"page of a brick fewer", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 1u); }},
    {"page of a byte more", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 2 * 729u + 1); }},
    {"page of a byte fewer", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 2 * 729u - 1); }},
    {"page as of solid bricks", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 2 * 512u); }},
    {"page of 0 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 0u); }},
    {"page that wraps around", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 0x80000002u); }},
    {"page checksum", ErrorCode::kChecksum,
     [](PackSurgeon& s) { set(s.content("GRID"), 24, std::uint64_t{1}); }},
    {"frame of a byte more", kCorrupt,
     [](PackSurgeon& s) {
       s.editPage([](Bytes& p) { p.push_back(std::byte{0}); });
       set(s.content("GRID"), 20, 2 * 729u);
     }},
    {"frame of a byte fewer", kCorrupt,
     [](PackSurgeon& s) {
       s.editPage([](Bytes& p) { p.pop_back(); });
       set(s.content("GRID"), 20, 2 * 729u);
     }},
    {"heat that the part has not", kCorrupt,
     [](PackSurgeon& s) { s.editPage([](Bytes& p) { p.resize(4 * 729, std::byte{1}); }); }},
    {"no heat where the part has it", kCorrupt,
     [](PackSurgeon& s) { s.editPage(flameGrid(s), [](Bytes& p) { p.resize(729); }); }},
    {"first brick clear", kCorrupt,
     [](PackSurgeon& s) { s.editPage([](Bytes& p) { std::fill_n(p.begin(), 729, std::byte{0}); }); }},
    {"last brick clear", kCorrupt,
     [](PackSurgeon& s) { s.editPage([](Bytes& p) { std::fill_n(p.begin() + 729, 729, std::byte{0}); }); }},
    {"brick with heat clear", kCorrupt,
     [](PackSurgeon& s) { s.editPage(flameGrid(s), [](Bytes& p) { p.assign(2 * 729, std::byte{0}); }); }},
    {"not a zstd frame", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& bricks = s.content("FOGB");
       bricks[0] ^= std::byte{1};
       set(s.content("GRID"), 24, static_cast<std::uint64_t>(XXH3_64bits(bricks.data(), bricks.size())));
     }},
};

TEST(FogHostile, TheTinyPackItselfIsSound) {
  EXPECT_TRUE(readFog(fogBytes()).equal);
  // And the surgeon, who shares no code with the library, puts it together so that it reads the same.
  PackSurgeon surgeon(fogBytes());
  ASSERT_EQ(surgeon.content("FOGS").size(), 96u);
  EXPECT_TRUE(readFog(surgeon.build()).equal);
}

TEST(FogHostile, LiesInTheIndexAreRefused) { expectFogRefused(kFogIndexLies); }
TEST(FogHostile, LiesInTheTableAreRefused) { expectFogRefused(kFogTableLies); }
TEST(FogHostile, LiesInLevelsAreRefused) { expectFogRefused(kFogLevelLies); }

TEST(FogHostile, ATableWithoutFogIsRefused) {
  const Lie superfluous[] = {
      {"FOGS of none", kCorrupt,
       [](PackSurgeon& s) {
         PackSurgeon::Chunk fogs;
         fogs.fourcc = PackSurgeon::fourcc("FOGS");
         fogs.flags = 1;
         fogs.content.resize(4, std::byte{0});
         s.chunks.insert(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("RIGS")), fogs);
       }},
      {"FOGB of none", kCorrupt,
       [](PackSurgeon& s) {
         s.chunks.push_back(s.chunks.back());
         s.chunks.back().fourcc = PackSurgeon::fourcc("FOGB");
       }},
  };
  expectFogRefused(superfluous, test::writeToMemory(test::makeTinyPack()));
}

TEST(FogHostile, EveryTruncationIsRefused) {
  const Bytes bytes = fogBytes();
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    const Reading reading = readFog(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    ASSERT_TRUE(reading.error) << size;
    ASSERT_EQ(reading.error->code, ErrorCode::kTruncated) << size;
  }
}

TEST(FogHostile, EveryChangedByteIsFoundByVerifyAndRefusedOrHarmlessToTheReader) {
  const Bytes bytes = fogBytes();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned change : {0x01u, 0x80u, 0xFFu}) {
      Bytes changed = bytes;
      changed[at] ^= static_cast<std::byte>(change);
      const Reading reading = readFog(changed);
      ASSERT_TRUE(reading.error || reading.equal) << at;
      ASSERT_FALSE(fogIssuesOf(changed).empty()) << at;
    }
  }
}

TEST(FogHostile, LimitsAreObeyed) {
  const auto refusal = [](const PackLimits& limits) {
    const Reading reading = readFog(fogBytes(), limits);
    return reading.error ? reading.error->code : ErrorCode::kMisuse;
  };
  EXPECT_EQ(refusal({1000000, 25, 100}), ErrorCode::kLimit);  // smoke is 26 wide
  EXPECT_EQ(refusal({1000000, 26, 2}), ErrorCode::kLimit);
  // All the metadata together are larger by a byte; the index is smaller.
  std::uint64_t metadata = 0;
  for (PackSurgeon surgeon(fogBytes()); const char* name : {"INFO", "PART", "MATL", "FOGS", "RIGS"})
    metadata += surgeon.content(name).size();
  ASSERT_GT(metadata, 48 * PackSurgeon(fogBytes()).chunks.size());
  EXPECT_EQ(refusal({1000000, 26, 3, metadata - 1}), ErrorCode::kLimit);
  EXPECT_TRUE(readFog(fogBytes(), {1000000, 26, 3, 3 * metadata}).equal);
}

// Faults that only the verifier finds, and its names for those that the reader finds too.
TEST(FogHostile, VerifyNamesWhatIsWrong) {
  struct Case {
    IssueId id;
    int part, level;
    void (*tell)(PackSurgeon& s);
  };
  const Case cases[] = {
      {IssueId::kMetadata, -1, -1, [](PackSurgeon& s) { takeOut(s, "FOGS"); }},
      {IssueId::kMetadata, -1, -1, [](PackSurgeon& s) { set(s.content("FOGS"), 16, 1.0f); }},
      {IssueId::kGrid, 1, 1, [](PackSurgeon& s) { set(s.content("GRID"), 20, 512u); }},
      {IssueId::kPage, 1, 1, [](PackSurgeon& s) { set(s.content("GRID"), 24, std::uint64_t{1}); }},
      {IssueId::kClearBrick, 1, 1,
       [](PackSurgeon& s) { s.editPage([](Bytes& p) { std::fill_n(p.begin(), 729, std::byte{0}); }); }},
      // 13 x 6 x 5 samples: the first brick has room in x, the second for 5.
      {IssueId::kFogOutside, 1, 1,
       [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[9 * 6] = std::byte{1}; }); }},
      {IssueId::kFogOutside, 1, 1,
       [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[81 * 5] = std::byte{1}; }); }},
      {IssueId::kFogOutside, 1, 1,
       [](PackSurgeon& s) { s.editPage([](Bytes& p) { p[729 + 5] = std::byte{1}; }); }},
      {IssueId::kFogOutside, 2, 0,
       [](PackSurgeon& s) { s.editPage(flameGrid(s), [](Bytes& p) { p[729 + 1] = std::byte{1}; }); }},
  };
  for (const Case& c : cases) {
    PackSurgeon surgeon(fogBytes());
    c.tell(surgeon);
    const std::vector<Issue> issues = fogIssuesOf(surgeon.build());
    ASSERT_EQ(issues.size(), 1u);
    EXPECT_EQ(issues[0].id, c.id) << issues[0].error.detail;
    EXPECT_EQ(issues[0].part, c.part);
    EXPECT_EQ(issues[0].level, c.level);
  }
  EXPECT_TRUE(fogIssuesOf(fogBytes()).empty());
}

}  // namespace
}  // namespace kelp

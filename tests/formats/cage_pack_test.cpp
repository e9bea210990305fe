// SPDX-License-Identifier: MIT
// Packs with cages: written, read again, refused, and within the limits.
#include <gtest/gtest.h>

#include <random>

#include "cage_lies.h"
#include "kelp/formats/verify.h"
#include "pack_compare.h"
#include "pack_surgeon.h"
#include "support/random_pack.h"
#include "support/short_memory.h"
#include "tiny_cage_pack.h"

namespace kelp {
namespace {

using test::IsSolid;

// Random solids, on several levels.
RawPack makeRandomCagePack(std::uint32_t seed) {
  RawPack pack = test::makeTinyPack();
  std::mt19937 random(seed);
  for (int i = 0; i < 2; ++i) {
    const glm::ivec3 size(5 + random() % 14, 5 + random() % 14, 5 + random() % 14);
    const std::uint32_t share = 2 + random() % 8, salt = random();
    const IsSolid solid = [=](const glm::ivec3& v) {
      const glm::uvec3 u(v);
      const std::uint32_t hash = (u.x * 73856093u ^ u.y * 19349663u ^ u.z * 83492791u) * 2654435769u;
      return test::isInBox(v, {0, 0, 0}, size) && (v == glm::ivec3(0) || (hash ^ salt) % 10007 % 10 < share);
    };
    pack.parts.push_back(
        test::makeCagedPart(size, 1 + static_cast<int>(random() % 4), 2 << random() % 4, solid));
  }
  for (int i = 0; i < 4; ++i) pack.parts.push_back(pack.parts[1]);  // more to follow
  for (std::size_t i = 2; i < 4; ++i)
    if (random() % 3 > 0) test::addInfluences(pack.parts[i], i, pack.parts.size(), random());
  const auto first = static_cast<std::uint32_t>(pack.parts.size());
  for (std::size_t i = 2; i < 4; ++i)
    if (random() % 2 > 0 && !pack.parts[i].influences.empty())
      test::addMorphs(pack.parts[i], {first, first + 1}, random());
  for (int i = 0; i < 2; ++i) pack.parts.push_back(test::makeTinyMorphPack().parts[4]);
  return pack;
}

TEST(CagePack, ComesBackExactly) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const RawPack raw = makeRandomCagePack(seed);
    const std::vector<std::byte> bytes = test::writeToMemory(raw);
    MemorySource memory(bytes);
    const Result<Pack> pack = Pack::open(memory.source());
    ASSERT_TRUE(pack) << pack.error().detail;
    EXPECT_EQ(pack->minorVersion(), 3);
    const test::Comparison result = test::compare(*pack, raw);
    ASSERT_TRUE(result.status) << result.status.error().detail;
    EXPECT_TRUE(result.equal);
    EXPECT_EQ(verify(memory.source(), {}, nullptr, nullptr), 0u);
    for (const Part& part : pack->parts()) {
      for (int level = 0; !part.cages.empty() && level < part.levels; ++level) {
        const Cage& cage = part.cages[static_cast<std::size_t>(level)];
        EXPECT_EQ(cage.level, level);
        EXPECT_EQ(cage.last_level, std::min(level + 1, part.levels - 1));
      }
    }
  }
}

// True if the writer refuses makeTinyCagePack() with a part spoiled, and writes nothing.
template <class Spoil>
bool refusesPart(std::size_t part, const Spoil& spoil) {
  RawPack pack = test::makeTinyCagePack();
  spoil(pack.parts[part]);
  std::vector<std::byte> bytes;
  const Result<void> written = writePack(pack, Sink::into(bytes));
  EXPECT_EQ(bytes.empty(), !written);
  return !written && written.error().code == ErrorCode::kMisuse;
}

TEST(CagePack, TheWriterRefusesWrongOnes) {
  const auto refuses = [](auto spoil) { return refusesPart(2, spoil); };
  EXPECT_TRUE(refuses([](RawPart& part) { part.cell = 3; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cell = 0; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cell = 8; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages.pop_back(); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages[0].blocks.pop_back(); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages[1].masks.pop_back(); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages[0].splits.push_back(0); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages[1].follows.pop_back(); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages[0].follows.push_back(0); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.levels.clear(); }));
}

TEST(CagePack, TheWriterRefusesWrongInfluences) {
  const auto refuses = [](auto spoil) { return refusesPart(3, spoil); };
  const auto with = [](const Influences& node) {
    return [node](RawPart& part) { part.influences[7] = node; };
  };
  EXPECT_FALSE(refuses(with({{0, 1, 2}, {1, 1, 253}})));
  EXPECT_FALSE(refuses(with({{2}, {255}})));
  EXPECT_TRUE(refuses(with({{}, {}})));
  EXPECT_TRUE(refuses(with({{0, 1}, {127, 127}})));
  EXPECT_TRUE(refuses(with({{0, 1}, {128, 128}})));
  EXPECT_TRUE(refuses(with({{0, 1, 2}, {100, 0, 155}})));
  EXPECT_TRUE(refuses(with({{1, 0}, {100, 155}})));
  EXPECT_TRUE(refuses(with({{1, 1}, {100, 155}})));
  EXPECT_TRUE(refuses(with({{3}, {255}})));  // itself
  EXPECT_TRUE(refuses(with({{4}, {255}})));
  EXPECT_TRUE(refuses([](RawPart& part) { part.influences.pop_back(); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.cages.clear(); }));
}

TEST(CagePack, TheWriterRefusesWrongMorphs) {
  const auto refuses = [](auto spoil) {
    RawPack pack = test::makeTinyMorphPack();
    spoil(pack.parts[2]);
    std::vector<std::byte> bytes;
    const Result<void> written = writePack(pack, Sink::into(bytes));
    EXPECT_EQ(bytes.empty(), !written);
    return !written && written.error().code == ErrorCode::kMisuse;
  };
  EXPECT_FALSE(refuses([](RawPart& part) { part.morphs.pop_back(); }));
  EXPECT_FALSE(refuses([](RawPart& part) { part.morphs[0].nodes = {}, part.morphs[0].offsets = {}; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].nodes.pop_back(); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].nodes.back() = 1u << 20; }));
  EXPECT_TRUE(refuses([](RawPart& part) { std::swap(part.morphs[0].nodes[0], part.morphs[0].nodes[1]); }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].offsets[0].y = -(1 << 20) - 1; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].part = 0; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].part = 4; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].part = 5; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.morphs[0].part = 6; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.sections = 3; }));
  for (const float step : {0.0f, -1.0f, test::kNan, test::kInfinity, 1e37f})
    EXPECT_TRUE(refuses([step](RawPart& part) { part.morphs[1].step = step; }));
  EXPECT_TRUE(refuses([](RawPart& part) { part.influences.clear(); }));
}

// The limits on metadata bound cages too, and what making them takes.
TEST(CagePack, MemoryIsBounded) {
  const glm::ivec3 size(40);
  const IsSolid solid = [&](const glm::ivec3& v) { return test::isInBox(v, {0, 0, 0}, size); };
  RawPack raw = test::makeTinyPack();
  raw.parts[0] = test::makeCagedPart(size, 1, 2, solid);
  raw.clips.clear();
  const std::vector<std::byte> bytes = test::writeToMemory(raw);
  MemorySource source(bytes);
  bool opened = false;
  int refused = 0;
  for (std::uint64_t most = 10000; !opened; most += most / 8, ++refused) {
    PackLimits limits;
    limits.max_metadata_bytes = most;
    test::ShortMemory memory;
    const Result<Pack> pack = Pack::open(source.source(), limits, memory.allocator());
    opened = static_cast<bool>(pack);
    EXPECT_TRUE(opened || pack.error().code == ErrorCode::kLimit);
    EXPECT_LE(memory.peak_bytes, 2 * most + 2 * bytes.size() + (std::uint64_t{1} << 18));
  }
  EXPECT_GT(refused, 8);
}

// Counts that claim gigabytes, or as much as the limits allow, cost no memory.
TEST(CagePack, ClaimsAreNotBelieved) {
  const test::Bytes sound = test::writeToMemory(test::makeTinyCagePack());
  for (const std::uint32_t number : {0xffffffffu, 10000000u}) {
    for (std::size_t at = 0; at < 20; ++at) {
      test::PackSurgeon lying(sound);
      test::setCountOfCage(lying.content("CAGE"), at / 5, at % 5, number);
      const test::Bytes bytes = lying.build();
      MemorySource source(bytes);
      test::ShortMemory memory;
      EXPECT_FALSE(Pack::open(source.source(), {}, memory.allocator()));
      EXPECT_LT(memory.peak_bytes, 300000u) << at;
    }
  }
}

TEST(CagePack, OtherRigsLeaveItAsItIs) {
  const RawPack raw = test::makeTinyCagePack();
  const std::vector<std::byte> bytes = test::writeToMemory(raw);
  RawRigs rigs{raw.info_json, {}, raw.clips, raw.sockets};
  for (const RawPart& part : raw.parts)
    rigs.parts.push_back({part.knots, part.automatic_tangents, part.parent_at, part.bend, part.roll});
  MemorySource source(bytes);
  std::vector<std::byte> again;
  ASSERT_TRUE(writeRigs(source.source(), rigs, Sink::into(again)));
  EXPECT_EQ(again, bytes);
}

// Cages come and go with the rigs: as if the pack had been written that way.
TEST(CagePack, OtherCagesReplaceIt) {
  const RawPack caged = test::makeTinyCagePack();
  RawPack plain = caged;
  for (RawPart& part : plain.parts) part.cell = 0, part.cages.clear(), part.influences.clear();
  for (const bool joints : {false, true}) {
    const auto bytesOf = [joints](RawPack pack) {
      if (joints) pack.joints = {{"hip", -1, glm::mat4x3(1), {0}}};
      return test::writeToMemory(pack);
    };
    for (const bool to_caged : {false, true}) {
      const std::vector<std::byte> from = bytesOf(to_caged ? plain : caged);
      RawRigs rigs{caged.info_json, {}, caged.clips, caged.sockets, std::vector<RawCages>()};
      for (const RawPart& part : caged.parts) {
        rigs.parts.push_back({part.knots, part.automatic_tangents, part.parent_at, part.bend, part.roll});
        rigs.cages->push_back(to_caged ? RawCages{part.cell, part.cages, part.influences, part.morphs, -1}
                                       : RawCages{});
      }
      MemorySource source(from);
      std::vector<std::byte> to;
      ASSERT_TRUE(writeRigs(source.source(), rigs, Sink::into(to)));
      EXPECT_EQ(to, bytesOf(to_caged ? caged : plain));
      rigs.cages->pop_back();
      EXPECT_EQ(writeRigs(source.source(), rigs, Sink::into(to)).error().code, ErrorCode::kMisuse);
    }
  }
}

}  // namespace
}  // namespace kelp

// SPDX-License-Identifier: MIT
// Fog goes into a pack and comes out as it was; what the writer refuses of it.
#include "kelp/formats/fog.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kelp/formats/level.h"
#include "kelp/formats/verify.h"
#include "pack_compare.h"
#include "support/random_pack.h"
#include "support/straight_knots.h"
#include "tiny_fog_pack.h"

namespace kelp {
namespace {

// Noise, mostly clear in some bricks, never so in all.
RawPart noise(const glm::ivec3& size, bool heat, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto field = [&](const glm::ivec3& v) {
    return static_cast<std::uint8_t>(v == glm::ivec3(0) || random() % 97 == 0 ? 1 + random() % 255 : 0);
  };
  RawPart part;
  part.name = "fog";
  part.size = size;
  part.knots = test::straightKnots();
  part.fog = RawFog{{0.5f, 1, 0}, 0.25f, heat ? 3.0f : 0.0f, {}};
  for (int i = 0; heat && i < 2 + static_cast<int>(seed % 255); ++i)
    part.fog->ramp.push_back({static_cast<float>(i), 0.5f, 0});
  for (int level = 0; level < 1 + static_cast<int>(seed % 3); ++level)
    part.levels.push_back(test::fogLevel(levelSize(size, level), 0.5f / static_cast<float>(level + 1), field,
                                         heat ? field : test::FogField()));
  return part;
}

void expectComesBack(const RawPack& raw) {
  const std::vector<std::byte> bytes = test::writeToMemory(raw);
  EXPECT_EQ(test::writeToMemory(raw, 3), bytes);
  MemorySource memory(bytes);
  const Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack) << pack.error().detail << " at " << pack.error().offset;
  const test::Comparison result = test::compare(*pack, raw);
  ASSERT_TRUE(result.status) << result.status.error().detail;
  EXPECT_TRUE(result.equal);
  EXPECT_EQ(verify(memory.source(), {}, nullptr, nullptr), 0u);
}

TEST(Fog, SidesAroundABrickComeBackExactlyBesideASolidPart) {
  std::uint32_t seed = 0;
  for (const int x : {1, 8, 9, 10, 17}) {
    for (const int y : {1, 8, 9, 10, 17}) {
      for (const int z : {1, 8, 9, 10, 17}) {
        SCOPED_TRACE(testing::Message() << x << " x " << y << " x " << z);
        RawPack raw = test::makeRandomPack(++seed, {1, 12, 2, 1});
        raw.parts.insert(seed % 2 ? raw.parts.begin() : raw.parts.end(),
                         noise({x, y, z}, seed % 4 < 2, seed));
        // The clips were made for the solid part alone, which may now be the second.
        if (seed % 2) raw.clips.clear();
        expectComesBack(raw);
      }
    }
  }
}

TEST(Fog, SeveralPartsShareOneTable) {
  RawPack raw = test::makeRandomPack(4, {2, 20, 3, 0});
  for (std::uint32_t i = 0; i < 5; ++i)
    raw.parts.push_back(noise({9 + static_cast<int>(i), 20, 11}, i % 2 == 0, i));
  expectComesBack(raw);
  raw.parts.resize(2);
  expectComesBack(raw);
  expectComesBack(test::makeTinyFogPack());
}

TEST(Fog, BendsInEitherWay) {
  RawPack raw = test::makeTinyFogPack();
  for (const std::size_t part : {1u, 2u}) {
    raw.parts[part].knots = {{0, {0, 0, 0}, {0, 9.4f, 0}}, {1, {6, 6, 0}, {9.4f, 0, 0}}};
    raw.parts[part].bend = Bend::kSweep;
    raw.parts[part].roll = 0.5f;
  }
  expectComesBack(raw);
}

TEST(Fog, PagesAreAsFullAsTheyCanBe) {
  for (const bool heat : {false, true}) {
    RawPack raw = test::makeRandomPack(1, {1, 8, 1, 0});
    RawPart fog = noise({70, 65, 66}, heat, 3);
    fog.levels.resize(1);
    raw.parts = {fog};
    expectComesBack(raw);
    const std::vector<std::byte> bytes = test::writeToMemory(raw);
    MemorySource memory(bytes);
    const Result<Pack> pack = Pack::open(memory.source());
    ASSERT_TRUE(pack);
    const Result<LevelGrid> grid = pack->readGrid(0, 0);
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->size, glm::ivec3(69, 64, 65));
    EXPECT_EQ(grid->grid, glm::ivec3(9, 8, 9));
    ASSERT_GT(grid->pages.size(), 3u);
    // 89 bricks of 729 bytes fit 64 KiB, 44 of twice as many.
    for (std::size_t i = 0; i + 1 < grid->pages.size(); ++i) {
      EXPECT_EQ(grid->pages[i].count, heat ? 44u : 89u);
      EXPECT_EQ(grid->pages[i].channels, heat ? 2 : 1);
    }
  }
}

TEST(Fog, CodesAreTheNearestSquares) {
  for (int code = 0; code < 256; ++code) {
    const double density = code * code / 65025.0;
    EXPECT_FLOAT_EQ(fogDensity(static_cast<std::uint8_t>(code)), static_cast<float>(density));
    EXPECT_EQ(fogCode(density), code);
  }
  for (int i = 0; i <= 100000; ++i) {
    const double density = i / 100000.0;
    const auto away = [&](int code) { return std::abs(code * code / 65025.0 - density); };
    const int code = fogCode(density);
    EXPECT_LE(away(code), std::min(code > 0 ? away(code - 1) : 1, code < 255 ? away(code + 1) : 1) + 1e-15)
        << density;
  }
}

// A mistake, made in the tiny pack of fog: 0 is solid, 1 smoke of two levels, 2 flame with heat.
struct FogMistake {
  const char* name;
  void (*make)(RawPack& pack);
};

const FogMistake kFogMistakes[] = {
    {"a sample too few", [](RawPack& p) { p.parts[1].levels[0].density.pop_back(); }},
    {"a brick of samples too many",
     [](RawPack& p) { p.parts[1].levels[0].density.resize(p.parts[1].levels[0].density.size() + 729, 1); }},
    {"no samples", [](RawPack& p) { p.parts[1].levels[0].density.clear(); }},
    {"no heats", [](RawPack& p) { p.parts[2].levels[0].heat.clear(); }},
    {"a heat too few", [](RawPack& p) { p.parts[2].levels[0].heat.pop_back(); }},
    {"heats without a ramp", [](RawPack& p) { p.parts[1].levels[0].heat = p.parts[1].levels[0].density; }},
    {"a ramp without heats", [](RawPack& p) { p.parts[1].fog->ramp = p.parts[2].fog->ramp; }},
    {"a cell too few", [](RawPack& p) { p.parts[1].levels[0].cells.pop_back(); }},
    {"cells of voxels instead of cubes", [](RawPack& p) { p.parts[2].levels[0].cells.resize(2); }},
    {"slot twice", [](RawPack& p) { p.parts[1].levels[0].cells[1] = kCellSolid; }},
    {"nothing stored",
     [](RawPack& p) {
       p.parts[1].levels[1] = {{0, 0}, {}, {}, {}, {}, 1.0f};
     }},
    {"a sample beyond x", [](RawPack& p) { p.parts[2].levels[0].density[1] = 1; }},
    {"a sample beyond y", [](RawPack& p) { p.parts[1].levels[1].density[9 * 6] = 1; }},
    {"a sample beyond z", [](RawPack& p) { p.parts[2].levels[0].density[81 * 2] = 1; }},
    {"a heat beyond x", [](RawPack& p) { p.parts[2].levels[0].heat[1] = 1; }},
    {"a stored brick that is clear",
     [](RawPack& p) { std::fill_n(p.parts[1].levels[0].density.begin(), 729, std::uint8_t{0}); }},
    {"codes in fog", [](RawPack& p) { p.parts[1].levels[0].codes = p.parts[0].levels[0].codes; }},
    {"attributes in fog", [](RawPack& p) { p.parts[1].levels[0].attributes = {0}; }},
    {"samples in a solid part", [](RawPack& p) { p.parts[0].levels[0].density.assign(729, 1); }},
    {"heats in a solid part", [](RawPack& p) { p.parts[0].levels[0].heat.assign(729, 1); }},
    {"fog said to be solid", [](RawPack& p) { p.parts[1].fog.reset(); }},
    {"solid said to be fog", [](RawPack& p) { p.parts[0].fog = RawFog{}; }},
    {"extinction 0", [](RawPack& p) { p.parts[1].levels[1].extinction = 0; }},
    {"extinction below 0", [](RawPack& p) { p.parts[1].levels[0].extinction = -1; }},
    {"extinction infinite", [](RawPack& p) { p.parts[2].levels[0].extinction = test::kInfinity; }},
    {"extinction not a number", [](RawPack& p) { p.parts[2].levels[0].extinction = test::kNan; }},
    {"anisotropy 1", [](RawPack& p) { p.parts[1].fog->anisotropy = 1; }},
    {"anisotropy -1", [](RawPack& p) { p.parts[1].fog->anisotropy = -1; }},
    {"anisotropy not a number", [](RawPack& p) { p.parts[1].fog->anisotropy = test::kNan; }},
    {"color above 1", [](RawPack& p) { p.parts[1].fog->color.g = 1.5f; }},
    {"color below 0", [](RawPack& p) { p.parts[2].fog->color.b = -0.5f; }},
    {"glow below 0", [](RawPack& p) { p.parts[2].fog->glow = -1; }},
    {"glow infinite", [](RawPack& p) { p.parts[2].fog->glow = test::kInfinity; }},
    {"ramp of 1 color", [](RawPack& p) { p.parts[2].fog->ramp.resize(1); }},
    {"ramp of 257 colors", [](RawPack& p) { p.parts[2].fog->ramp.resize(257); }},
    {"ramp below 0", [](RawPack& p) { p.parts[2].fog->ramp[1].r = -1; }},
    {"ramp not a number", [](RawPack& p) { p.parts[2].fog->ramp[0].b = test::kNan; }},
};

TEST(Fog, TheWriterRefusesEveryMistakeBeforeItWritesAByte) {
  for (const FogMistake& mistake : kFogMistakes) {
    SCOPED_TRACE(mistake.name);
    RawPack pack = test::makeTinyFogPack();
    mistake.make(pack);
    std::size_t calls = 0;
    const Sink sink{[](void* user, std::span<const std::byte>) {
                      ++*static_cast<std::size_t*>(user);
                      return Result<void>();
                    },
                    &calls};
    const Result<void> written = writePack(pack, sink);
    if (written) {
      ADD_FAILURE() << "written";
      continue;
    }
    EXPECT_EQ(written.error().code, ErrorCode::kMisuse) << written.error().detail;
    EXPECT_STRNE(written.error().detail, "");
    EXPECT_EQ(calls, 0u);
  }
}

}  // namespace
}  // namespace kelp

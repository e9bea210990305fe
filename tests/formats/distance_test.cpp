// SPDX-License-Identifier: MIT
// Distances against every pair of voxels, and packs whose distances lie with every checksum right.
#include "kelp/formats/distance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "kelp/formats/level.h"
#include "kelp/formats/verify.h"
#include "lying_pack.h"
#include "support/all_tests.h"
#include "tiny_distance_pack.h"
#include "tiny_fog_pack.h"

namespace kelp {
namespace {

using test::kCorrupt;
using test::Lie;
using test::PackSurgeon;

// Bricks of noise around a brick, some of them unknown.
struct Neighborhood {
  std::array<BrickBits, 125> bits;
  std::array<const BrickBits*, 125> around{};

  Neighborhood(std::mt19937& random, unsigned shift, bool all_known) {
    for (std::size_t i = 0; i < bits.size(); ++i) {
      for (std::uint64_t& slice : bits[i].slices) {
        slice = ~std::uint64_t{0};
        for (unsigned k = 0; k < shift; ++k) slice &= std::uint64_t{random()} << 32 | random();
        if (random() % 4 == 0) slice = random() % 2 ? 0 : ~std::uint64_t{0};
      }
      if (all_known || i == 62 || random() % 3) around[i] = &bits[i];
    }
  }
  // -1: unknown.
  int at(const glm::ivec3& v) const {
    const glm::ivec3 p = v + 16;
    const BrickBits* const brick = around[static_cast<std::size_t>(p.x / 8 + 5 * (p.y / 8 + 5 * (p.z / 8)))];
    return brick ? static_cast<int>(brick->slices[p.z % 8] >> (p.x % 8 + 8 * (p.y % 8)) & 1) : -1;
  }
};

TEST(Distance, CodesAreThoseOfEveryPairOfVoxels) {
  const DistanceBand bands[] = {{}, kNarrowestBand, kWidestBand, {80, 4}, {81, 9}, {64, 28}};
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(test::shareOf(60)); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Neighborhood n(random, 1 + seed % 8, seed % 3 == 0);
    const DistanceBand band = bands[seed % std::size(bands)];
    std::array<std::uint8_t, kBrickVoxels> codes;
    computeDistanceCodes(n.around, band, codes);
    for (int i = 0; i < kBrickVoxels; i += 1 + static_cast<int>(random() % 9)) {
      const glm::ivec3 voxel(i & 7, i >> 3 & 7, i >> 6);
      const int own = n.at(voxel), limit = own ? band.inside : band.outside;
      int nearest = limit + 1;
      glm::ivec3 d;
      for (d.z = -15; d.z <= 15; ++d.z)
        for (d.y = -15; d.y <= 15; ++d.y)
          for (d.x = -15; d.x <= 15; ++d.x)
            if (const int squared = d.x * d.x + d.y * d.y + d.z * d.z;
                squared < nearest && n.at(voxel + d) == 1 - own)
              nearest = squared;
      const int expected = nearest > limit ? (own ? 255 : 0) : own ? 255 - nearest : nearest;
      ASSERT_EQ(codes[static_cast<std::size_t>(i)], expected) << i;
    }
  }
}

TEST(Distance, LevelsGoOnUntilEightVoxels) {
  EXPECT_EQ(distanceLevels({8, 1, 8}, 1), 1);
  EXPECT_EQ(distanceLevels({9, 1, 8}, 1), 2);
  EXPECT_EQ(distanceLevels({1, 512, 8}, 1), 7);
  EXPECT_EQ(distanceLevels({32768, 1, 1}, 1), 13);
  EXPECT_EQ(distanceLevels({8, 8, 8}, 4), 4);
  EXPECT_EQ(distanceBand({20, 20, 20}, 1, 2), kWidestBand);
  EXPECT_EQ(distanceBand({20, 20, 20}, 1, 1), DistanceBand());
  // The widest band holds the farthest that a voxel of eight can be from one of the other kind.
  EXPECT_GE(kWidestBand.outside, 3 * 7 * 7);
  EXPECT_GE(kWidestBand.inside, 4 * 4);
}

TEST(Distance, GradientOfAPlaneIsItsNormal) {
  // Voxels with x < 0 are solid: codes along x are 251 (d = 2), 254, then 1, 4, 9.
  const std::uint8_t beside[] = {254, 4, 1, 1, 1, 1};
  EXPECT_EQ(distanceGradient(1, beside), glm::vec3(1, 0, 0));
  const std::uint8_t one_sided[] = {9, 0, 0, 0, 16, 0};
  EXPECT_EQ(distanceGradient(16, one_sided), glm::vec3(1, 0, 0));  // 4 - 3 along x, nothing along z
  const std::uint8_t unknown[] = {1, 1, 1, 1, 1, 1};
  EXPECT_EQ(distanceGradient(kFarOutside, unknown), glm::vec3(0));
  EXPECT_EQ(signedDistanceOf(254), -0.5f);
  EXPECT_EQ(signedDistanceOf(4), 1.5f);
  EXPECT_EQ(signedDistanceOf(0), INFINITY);
  EXPECT_EQ(signedDistanceOf(255), -INFINITY);
}

// Of a ball the gradient is the direction from the middle, up to the steps of voxels.
TEST(Distance, GradientOfABallPointsOutward) {
  const glm::ivec3 size(48);
  const auto ball = [](const glm::ivec3& v) { return glm::length(glm::vec3(v) - 23.5f) < 14; };
  const RawDistances level = test::bruteDistances(size, {64, 9}, ball);
  const auto codeAt = [&](const glm::ivec3& v) {
    const glm::ivec3 brick = v / 8;
    const std::uint32_t cell = level.cells[static_cast<std::size_t>(brick.x + 6 * (brick.y + 6 * brick.z))];
    return cell & kCellSolid
               ? level.codes[(cell & kCellSlotMask) * 512 + static_cast<std::size_t>(codeIndex(v))]
               : static_cast<std::uint8_t>(cell);
  };
  double sum = 0;
  int count = 0;
  glm::ivec3 v;
  for (v.z = 1; v.z < 47; ++v.z) {
    for (v.y = 1; v.y < 47; ++v.y) {
      for (v.x = 1; v.x < 47; ++v.x) {
        const int squared = squaredOf(codeAt(v));
        if (squared < 4) continue;
        std::uint8_t beside[6];
        for (int side = 0; side < 6; ++side) {
          glm::ivec3 d(0);
          d[side / 2] = side % 2 ? 1 : -1;
          beside[side] = codeAt(v + d);
        }
        const float cosine =
            glm::dot(distanceGradient(codeAt(v), beside), glm::normalize(glm::vec3(v) - 23.5f));
        sum += std::acos(std::min(cosine, 1.0f));
        ++count;
      }
    }
  }
  ASSERT_GT(count, 1000);
  EXPECT_LT(sum / count * 57.3, 8.0);
}

// More than one page, and levels beyond those of the voxels.
TEST(Distance, ArriveAsTheyWereWritten) {
  RawPack pack = test::makeTinyPack();
  pack.parts.resize(1);
  pack.clips.clear();
  pack.sockets.clear();
  pack.parts[0].distances = test::makeTinyDistancePack().parts[0].distances;
  std::mt19937 random(3);
  // Noise makes every brick a stored one: 6 x 6 x 4 of them.
  std::vector<bool> solid(48 * 48 * 32);
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = random() % 50 == 0;
  pack.parts[0].size = {48, 48, 32};
  pack.parts[0].levels.resize(1);
  pack.parts[0].levels[0].cells.assign(6 * 6 * 4, 0);
  pack.parts[0].levels[0].cells[0] = kCellSolid;
  pack.parts[0].levels[0].codes.resize(kBrickVoxels);
  pack.parts[0].levels[0].attributes.resize(26);  // those of the tiny cube
  pack.parts[0].distances = test::bruteDistancesOf({48, 48, 32}, 1, [&](const glm::ivec3& v) {
    return bool{solid[static_cast<std::size_t>(v.x + 48 * (v.y + 48 * v.z))]};
  });
  ASSERT_EQ(pack.parts[0].distances.size(), 4u);
  for (const RawPack& written : {pack, test::makeTinyDistancePack()}) {
    const test::Bytes bytes = test::writeToMemory(written);
    EXPECT_EQ(test::writeToMemory(written, 3), bytes);
    const test::Reading read = test::readAll(written, bytes);
    EXPECT_FALSE(read.error) << read.error->detail;
    EXPECT_TRUE(read.equal);
    MemorySource memory(bytes);
    EXPECT_EQ(verify(memory.source(), {}, nullptr, nullptr), 0u);
  }
}

TEST(Distance, PacksWithoutHaveNone) {
  MemorySource memory(test::tinyBytes());
  const Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  EXPECT_FALSE(pack->hasDistances());
  EXPECT_EQ(pack->distanceLevels(0), 0);
  EXPECT_EQ(pack->readDistanceGrid(0, 0).error().code, ErrorCode::kMisuse);
}

TEST(Distance, TheWriterRefusesWhatReadersWould) {
  const struct {
    const char* name;
    void (*spoil)(RawPack& pack);
  } kFaults[] = {
      {"one part without", [](RawPack& p) { p.parts[1].distances.clear(); }},
      {"a level too few", [](RawPack& p) { p.parts[0].distances.pop_back(); }},
      {"of fog", [](RawPack& p) { p.parts[0].fog.emplace(); }},
      {"cells", [](RawPack& p) { p.parts[0].distances[0].cells.pop_back(); }},
      {"slot", [](RawPack& p) { p.parts[0].distances[0].cells[0] ^= 1; }},
      {"cell", [](RawPack& p) { p.parts[1].distances[0].cells[0] = 7; }},
      {"codes", [](RawPack& p) { p.parts[0].distances[0].codes.pop_back(); }},
      {"band",
       [](RawPack& p) {
         p.parts[0].distances[0].band = {15, 4};
       }},
      {"too far", [](RawPack& p) { p.parts[1].distances[0].codes[0] = 2; }},  // its neighbor is solid
      {"solid outside", [](RawPack& p) { p.parts[1].distances[0].codes[2] = 254; }},
      {"all far",
       [](RawPack& p) {
         for (auto& code : p.parts[1].distances[0].codes) code = kFarOutside;
       }},
  };
  for (const auto& fault : kFaults) {
    RawPack pack = test::makeTinyDistancePack();
    fault.spoil(pack);
    const Sink nowhere{[](void*, std::span<const std::byte>) { return Result<void>(); }, nullptr};
    const Result<void> written = writePack(pack, nowhere);
    ASSERT_FALSE(written) << fault.name;
    EXPECT_EQ(written.error().code, ErrorCode::kMisuse) << fault.name;
  }
}

void editDistances(PackSurgeon& s, void (*edit)(test::Bytes& page)) { s.editPage(s.find("DGRD"), edit); }

const Lie kDistanceLies[] = {
    {"DGRD required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("DGRD")].flags |= 1; }},
    {"DIST compressed in one", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("DIST")].flags |= 2; }},
    {"last level missing", kCorrupt, [](PackSurgeon& s) { s.chunks.resize(s.chunks.size() - 2); }},
    {"pages missing", kCorrupt, [](PackSurgeon& s) { s.chunks.pop_back(); }},
    {"before the voxels", kCorrupt,
     [](PackSurgeon& s) {
       const auto first = s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("GRID"));
       std::rotate(first, s.chunks.end() - 2, s.chunks.end());
     }},
    {"another level", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("DGRD")].level = 1; }},
    {"another part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("DIST")].part = 1; }},
    {"band too narrow", kCorrupt, [](PackSurgeon& s) { s.content("DGRD")[0] = std::byte{15}; }},
    {"band too wide", kCorrupt, [](PackSurgeon& s) { s.content("DGRD")[1] = std::byte{29}; }},
    {"reserved", kCorrupt, [](PackSurgeon& s) { s.content("DGRD")[5] = std::byte{1}; }},
    {"cell", kCorrupt, [](PackSurgeon& s) { s.content("DGRD")[8] = std::byte{3}; }},
    {"no brick", kCorrupt, [](PackSurgeon& s) { s.content("DGRD")[8] = std::byte{1}; }},
    {"padding", kCorrupt, [](PackSurgeon& s) { s.content("DGRD")[9] = std::byte{1}; }},
    {"a cell too few", kCorrupt, [](PackSurgeon& s) { s.content("DGRD").resize(8); }},
    {"solid outside", kCorrupt,
     [](PackSurgeon& s) { editDistances(s, [](test::Bytes& p) { p[63] |= std::byte{0x80}; }); }},
    {"a byte too many", kCorrupt,
     [](PackSurgeon& s) { editDistances(s, [](test::Bytes& p) { p.push_back(std::byte{0}); }); }},
    {"farther than its bits say", kCorrupt,
     [](PackSurgeon& s) { editDistances(s, [](test::Bytes& p) { p[64] = std::byte{200}; }); }},
    {"no sum of three squares", kCorrupt,
     [](PackSurgeon& s) { editDistances(s, [](test::Bytes& p) { p[64 + 511] = std::byte{7}; }); }},
    {"what the bits say", kCorrupt,
     [](PackSurgeon& s) { editDistances(s, [](test::Bytes& p) { p[64 + 1] = std::byte{1}; }); }},
    {"all beyond the band", kCorrupt,
     [](PackSurgeon& s) {
       editDistances(s, [](test::Bytes& p) { std::fill(p.begin(), p.end(), std::byte{0}); });
     }},
};

TEST(Distance, LiesAreRefused) {
  const RawPack pack = test::makeTinyDistancePack();
  for (const Lie& lie : kDistanceLies) {
    SCOPED_TRACE(lie.name);
    PackSurgeon surgeon(test::writeToMemory(pack));
    lie.tell(surgeon);
    const test::Bytes bytes = surgeon.build();
    test::expectRefused(test::readAll(pack, bytes), bytes, lie.code);
    MemorySource memory(bytes);
    EXPECT_GT(verify(memory.source(), {}, nullptr, nullptr), 0u);
  }
}

// Every byte of a page, with its checksums right: refused, or distances within what the bits allow.
TEST(Distance, AnyPageIsRefusedOrWithinItsBits) {
  const RawPack pack = test::makeTinyDistancePack();
  const PackSurgeon sound(test::writeToMemory(pack));
  std::mt19937 random(1);
  int refused = 0, accepted = 0;
  for (int i = 0; i < test::shareOf(2000); ++i) {
    PackSurgeon lying = sound;
    const std::size_t grid = lying.chunks.size() - 2 * (1 + random() % 4);
    lying.editPage(grid, [&](test::Bytes& page) {
      page[random() % page.size()] ^= static_cast<std::byte>(1u << random() % 8);
    });
    const test::Bytes bytes = lying.build();
    MemorySource memory(bytes);
    const Result<Pack> opened = Pack::open(memory.source());
    ASSERT_TRUE(opened);
    const PackSurgeon::Chunk& chunk = lying.chunks[grid];
    const auto read =
        test::readDistances(*opened, static_cast<int>(chunk.part), static_cast<int>(chunk.level));
    if (!read.status) {
      EXPECT_EQ(read.status.error().code, kCorrupt);
      ++refused;
      continue;
    }
    ++accepted;
    for (const std::uint8_t code : read.level.codes)
      ASSERT_LE(squaredOf(code), isInside(code) ? read.level.band.inside : read.level.band.outside);
  }
  EXPECT_GT(refused, 20);
  EXPECT_GT(accepted, 20);
}

}  // namespace
}  // namespace kelp

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string_view>
#include <thread>

#include "kelp/formats/level.h"
#include "pack_compare.h"
#include "support/all_tests.h"
#include "support/random_pack.h"
#include "support/straight_knots.h"

namespace kelp {
namespace {

using test::compare;
using test::makeRandomPack;
using test::writeToMemory;

TEST(RoundTrip, RandomPacksComeBackExactly) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(test::shareOf(40)); ++seed) {
    const int joints = static_cast<int>(seed % 3);
    const RawPack raw =
        makeRandomPack(seed, {1 + static_cast<int>(seed % 5), 60, 5, static_cast<int>(seed % 4), 2, joints});
    const std::vector<std::byte> bytes = writeToMemory(raw);
    MemorySource memory(bytes);
    Result<Pack> pack = Pack::open(memory.source());
    ASSERT_TRUE(pack) << seed << ": " << pack.error().detail << " at " << pack.error().offset;
    const test::Comparison result = compare(*pack, raw);
    ASSERT_TRUE(result.status) << seed << ": " << result.status.error().detail;
    ASSERT_TRUE(result.equal) << seed;
    EXPECT_EQ(pack->fileSize(), bytes.size());
    EXPECT_EQ(pack->minorVersion(), joints > 0 ? 2 : 0);
  }
}

TEST(RoundTrip, ALevelOfManyPagesComesBackExactly) {
  RawPack raw = makeRandomPack(1, {1, 8, 1, 0});
  raw.parts[0].size = {200, 150, 90};
  raw.parts[0].knots = test::straightKnots();
  test::RandomPack random(5);
  raw.parts[0].levels = {random.makeLevel(raw.parts[0].size, raw.palette.size(), 0.5f)};
  const std::vector<std::byte> bytes = writeToMemory(raw, 2);
  MemorySource memory(bytes);
  Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  const Result<LevelGrid> grid = pack->readGrid(0, 0);
  ASSERT_TRUE(grid);
  EXPECT_GT(grid->pages.size(), 10u);
  const test::Comparison result = compare(*pack, raw);
  ASSERT_TRUE(result.status) << result.status.error().detail;
  EXPECT_TRUE(result.equal);
  // No page could have taken the next brick too, with the 16 bytes a brick that readers may add.
  for (std::size_t i = 0; i + 1 < grid->pages.size(); ++i) {
    const PageInfo& page = grid->pages[i];
    const std::uint8_t* next =
        raw.parts[0].levels[0].codes.data() + std::size_t{page.first_slot + page.count} * kBrickVoxels;
    const std::size_t surface =
        static_cast<std::size_t>(std::count_if(next, next + kBrickVoxels, isSurfaceCode));
    EXPECT_GT(page.raw + kBrickVoxels + 4 * surface + 16 * (page.count + 1), 64u * 1024);
    EXPECT_LE(page.raw + 16 * page.count, 64u * 1024);
  }
}

TEST(RoundTrip, BytesDoNotDependOnTheNumberOfThreads) {
  for (std::uint32_t seed = 100; seed < 106; ++seed) {
    const RawPack raw = makeRandomPack(seed, {4, 90, 4, 2});
    const std::vector<std::byte> once = writeToMemory(raw, 1);
    for (const int threads : {2, 3, 16}) EXPECT_EQ(writeToMemory(raw, threads), once) << threads;
  }
}

TEST(RoundTrip, ChunksAreCoarseToFineAlignedAndPaddedWithZeros) {
  const std::vector<std::byte> bytes = writeToMemory(makeRandomPack(7));
  MemorySource memory(bytes);
  Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  std::uint64_t end = 64 + 48 * pack->chunks().size();
  std::uint32_t level = 1000;
  for (const Pack::ChunkInfo& chunk : pack->chunks()) {
    EXPECT_EQ(chunk.offset % 64, 0u);
    EXPECT_LT(chunk.offset - end, 64u);
    for (std::uint64_t i = end; i < chunk.offset; ++i) EXPECT_EQ(bytes[i], std::byte{0});
    end = chunk.offset + chunk.stored;
    char name[5] = {};
    std::memcpy(name, &chunk.fourcc, 4);
    if (std::string_view(name) == "GRID" || std::string_view(name) == "BRCK") {
      EXPECT_LE(chunk.level, level);
      level = chunk.level;
    }
  }
  EXPECT_EQ(end, bytes.size());
  EXPECT_EQ(level, 0u);
}

TEST(Reader, PagesAreReadByManyThreadsAtOnce) {
  const RawPack raw = makeRandomPack(11, {2, 120, 2, 0});
  const std::vector<std::byte> bytes = writeToMemory(raw, 2);
  MemorySource memory(bytes);
  Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  std::vector<std::thread> threads;
  std::vector<int> good(4);
  for (std::size_t i = 0; i < good.size(); ++i) {
    threads.emplace_back([&, i] {
      const test::Comparison result = compare(*pack, raw);
      good[i] = result.status && result.equal;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, std::vector<int>(4, 1));
}

TEST(Reader, RefusesPartsLevelsAndPagesThatAreNotThere) {
  const RawPack raw = makeRandomPack(3);
  const std::vector<std::byte> bytes = writeToMemory(raw);
  MemorySource memory(bytes);
  Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  const auto misuse = [](const auto& result) { return !result && result.error().code == ErrorCode::kMisuse; };
  EXPECT_TRUE(misuse(pack->readGrid(-1, 0)));
  EXPECT_TRUE(misuse(pack->readGrid(static_cast<int>(raw.parts.size()), 0)));
  EXPECT_TRUE(misuse(pack->readGrid(0, -1)));
  EXPECT_TRUE(misuse(pack->readGrid(0, static_cast<int>(raw.parts[0].levels.size()))));
  Result<LevelGrid> grid = pack->readGrid(0, 0);
  ASSERT_TRUE(grid);
  PageData data;
  EXPECT_TRUE(misuse(pack->readPage(*grid, grid->pages.size(), {}, data)));
  ASSERT_FALSE(grid->coarsest);
  EXPECT_TRUE(misuse(pack->readPage(*grid, 0, {}, data))) << "without the coarser level";
  const Result<LevelGrid> above = pack->readGrid(0, 1);
  ASSERT_TRUE(above);
  const std::vector<BrickShape> unknown(above->bricks.size());
  EXPECT_TRUE(misuse(pack->readPage(*grid, 0, {&*above, unknown}, data))) << "with nothing known of it";
  EXPECT_TRUE(misuse(pack->readPage(*grid, 0, {&*grid, unknown}, data))) << "with another level";
  const PageInfo sound = grid->pages[0];
  for (const auto spoil :
       {+[](PageInfo& p) { p.offset = ~std::uint64_t{0}; }, +[](PageInfo& p) { p.stored = 0; },
        +[](PageInfo& p) { p.stored = 0xffffffffu; }, +[](PageInfo& p) { p.raw = 0xffffffffu; },
        +[](PageInfo& p) { p.raw += 1; }, +[](PageInfo& p) { p.count = 0; },
        +[](PageInfo& p) { p.count = 0xffffffu; }, +[](PageInfo& p) { p.raw = p.count * 512 - 4; }}) {
    grid->pages[0] = sound;
    spoil(grid->pages[0]);
    EXPECT_TRUE(misuse(pack->readPage(*grid, 0, {&*above, unknown}, data)));
  }
  EXPECT_TRUE(misuse(Pack::open(Source{})));
}

}  // namespace
}  // namespace kelp

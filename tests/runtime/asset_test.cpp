// SPDX-License-Identifier: MIT
#include "kelp/runtime/asset.h"
#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>

#include "support/all_tests.h"
#include "support/distance_pack.h"
#include "support/short_memory.h"
#include "support/test_pack.h"

namespace kelp::runtime {
namespace {

std::vector<std::byte> clumpBytes() {
  return test::bytesOf(test::packOf(test::ballClump({70, 90, 60}, 30, 1)));
}

// With distances.
std::vector<std::byte> fullBytes() {
  return test::bytesOf(test::distancePackOf(test::ballClump({70, 90, 60}, 30, 1)));
}

void expectHolds(const Asset& asset, const fields::Occupancy& volume) {
  const Level* level = asset.level(0, 0);
  ASSERT_NE(level, nullptr);
  ASSERT_EQ(level->size, volume.size);
  EXPECT_EQ(asset.residentLevel(0), 0);
  std::vector<PinnedPage> pages;
  for (std::uint32_t page = 0; page < level->pages.size(); ++page) {
    pages.push_back(PageAccess::pin(asset, {0, 0}, page, 1.0f));
    ASSERT_TRUE(pages.back());
  }
  const auto brickOf = [&](std::uint32_t cell) {
    return cellPage(cell) == pages.size()
               ? kSolidBrick.data()
               : pages[cellPage(cell)].words().data() + kBrickWords * cellBrick(cell);
  };
  std::vector<std::uint8_t> solid;
  for (glm::ivec3 v(0); v.z < volume.size.z; ++v.z) {
    for (v.y = 0; v.y < volume.size.y; ++v.y) {
      for (v.x = 0; v.x < volume.size.x; ++v.x) {
        const glm::ivec3 b = v / 8;
        const std::uint32_t cell =
            level->cells[static_cast<std::size_t>(b.x + level->grid.x * (b.y + level->grid.y * b.z))];
        solid.push_back(cell & kCellSolid ? isSolidCode(codeOf(brickOf(cell), v)) : 0);
      }
    }
  }
  EXPECT_EQ(solid, volume.solid);
}

TEST(Asset, LoadsWhatWasWritten) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  EXPECT_EQ((*asset)->level(0, 0), nullptr) << "nothing is resident before pump()";
  EXPECT_EQ((*asset)->residentLevel(0), std::nullopt);
  ASSERT_TRUE((*asset)->loadAll());
  expectHolds(**asset, test::ballClump({70, 90, 60}, 30, 1));
  EXPECT_EQ((*asset)->residentLevel(0, 1), 1);
  EXPECT_EQ((*asset)->level(0, 99), nullptr);
  EXPECT_EQ((*asset)->level(3, 0), nullptr);
  EXPECT_EQ((*asset)->level(-1, -1), nullptr);
}

TEST(Asset, NoLevelOfDistancesIsBelowZero) {
  const std::vector<std::byte> bytes = clumpBytes();
  const MemorySource source(bytes);
  AssetOptions options;
  options.distance_level = -1;
  EXPECT_EQ(Asset::open(source.source(), options).error().code, ErrorCode::kMisuse);
}

TEST(Asset, AnyNumberOfThreadsMayPump) {
  const std::vector<std::byte> bytes = fullBytes();
  MemorySource source(bytes);
  AssetOptions options;
  options.distance_level = 0;
  auto asset = Asset::open(source.source(), options);
  ASSERT_TRUE(asset);
  std::atomic<int> errors{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      while (((*asset)->residentLevel(0) != 0 || !(*asset)->distances(0, 0)) && errors == 0) {
        const Result<bool> more = (*asset)->pump();
        if (!more) ++errors;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(errors, 0);
  expectHolds(**asset, test::ballClump({70, 90, 60}, 30, 1));
}

TEST(Asset, LoadAllWaitsForPagesInOtherThreadsHands) {
  const std::vector<std::byte> bytes = clumpBytes();
  for (int i = 0; i < 40; ++i) {
    MemorySource source(bytes);
    auto asset = Asset::open(source.source());
    ASSERT_TRUE(asset);
    std::thread other([&] {
      while (true) {
        const Result<bool> more = (*asset)->pump();
        if (!more || !*more) break;
      }
    });
    EXPECT_TRUE((*asset)->loadAll());
    EXPECT_EQ((*asset)->residentLevel(0), 0) << "run " << i;
    other.join();
  }
}

TEST(Asset, LoadAllTellsOfErrorsThatAnotherThreadMet) {
  std::vector<std::byte> bytes = clumpBytes();
  bytes[bytes.size() - 100] ^= std::byte{1};
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  while (true) {
    const Result<bool> more = (*asset)->pump();
    if (more && !*more) break;
  }
  const Result<void> loaded = (*asset)->loadAll();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kChecksum);
}

TEST(Asset, ADamagedFineLevelLeavesTheCoarseOnes) {
  std::vector<std::byte> bytes = clumpBytes();
  bytes[bytes.size() - 100] ^= std::byte{1};  // in the last page: the finest level comes last
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  const Result<void> loaded = (*asset)->loadAll();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kChecksum);
  EXPECT_NE((*asset)->level(0, 0), nullptr) << "the other pages are there";
  EXPECT_EQ((*asset)->residentLevel(0), 1);
  const Result<bool> again = (*asset)->pump();
  ASSERT_TRUE(again);
  EXPECT_FALSE(*again);
}

// Each allocation alone, and with all after it.
TEST(Asset, AllocationFailureIsAnErrorEachTime) {
  const std::vector<std::byte> bytes = fullBytes();
  for (const bool and_on : {false, true}) {
    int failures = 0;
    bool refused = true;
    for (std::size_t n = 0; refused; n += test::kSanitized ? 3 : 1) {
      ASSERT_LT(n, 400u) << "never loaded";
      test::ShortMemory memory;
      memory.refuse_at = n;
      memory.and_on = and_on;
      AssetOptions options;
      options.allocator = memory.allocator();
      options.distance_level = 0;
      {
        MemorySource source(bytes);
        auto asset = Asset::open(source.source(), options);
        const Result<void> loaded = asset ? (*asset)->loadAll() : Result<void>(asset.error());
        refused = memory.requests > n;
        EXPECT_EQ(!loaded, refused) << n;
        if (!loaded) {
          ++failures;
          EXPECT_EQ(loaded.error().code, ErrorCode::kOutOfMemory) << n << ": " << loaded.error().detail;
        }
      }
      EXPECT_EQ(memory.live, 0u);
    }
    EXPECT_GT(failures, 5);
  }
}

TEST(Asset, KeepsToItsMemoryBudget) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  const std::uint64_t all = [&] {
    auto asset = Asset::open(source.source());
    EXPECT_TRUE((*asset)->loadAll());
    return (*asset)->memory();
  }();
  for (const std::uint64_t budget : {all - 1, all / 2, all / 4}) {
    AssetOptions options;
    options.memory_budget = budget;
    auto asset = Asset::open(source.source(), options);
    ASSERT_TRUE(asset);
    const Result<void> loaded = (*asset)->loadAll();
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().code, ErrorCode::kLimit);
    EXPECT_LE((*asset)->memory(), budget);
    EXPECT_GT((*asset)->residentLevel(0), 0) << "the coarse levels fit";
    EXPECT_FALSE(*(*asset)->pump());
  }
  AssetOptions none;
  none.memory_budget = 100;
  auto asset = Asset::open(source.source(), none);
  ASSERT_TRUE(asset);
  EXPECT_EQ((*asset)->loadAll().error().code, ErrorCode::kLimit);
  EXPECT_LE((*asset)->memory(), none.memory_budget);
  EXPECT_EQ((*asset)->residentLevel(0), std::nullopt);
}

TEST(Asset, DropsWhatNobodyAskedForLately) {
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(test::dust({96, 96, 96}, 9, 4)));
  MemorySource source(bytes);
  AssetOptions options;
  options.memory_budget = 800'000;
  auto opened = Asset::open(source.source(), options);
  ASSERT_TRUE(opened);
  Asset& asset = **opened;
  (void)asset.loadAll();
  const auto pages = static_cast<std::uint32_t>(asset.level(0, 0)->pages.size());
  ASSERT_GT(pages, 15u);
  // Page after page is asked for, for as many rounds as it takes.
  for (std::uint32_t page = 0; page < pages; ++page) {
    bool there = false;
    for (int round = 0; round < 20 && !there; ++round) {
      PageAccess::beginRequests(asset);
      there = static_cast<bool>(PageAccess::pin(asset, {0, 0}, page, 1.0f));
      while (*asset.pump()) {
      }
      EXPECT_LE(asset.memory(), options.memory_budget);
    }
    EXPECT_TRUE(there) << page;
  }
  EXPECT_GE(asset.residentLevel(0, 9), 0) << "the coarsest level stays";
}

TEST(Asset, ASourceThatFailsForAWhileIsAskedAgain) {
  const std::vector<std::byte> bytes = clumpBytes();
  // A download: the first `there` bytes have come.
  struct Download {
    const std::vector<std::byte>& all;
    std::atomic<std::uint64_t> there;
  } download{bytes, bytes.size() / 3};
  const Source source{[](void* user, std::uint64_t offset, std::span<std::byte> out) {
                        const Download& d = *static_cast<const Download*>(user);
                        if (offset + out.size() > d.there) return Read::kFailed;
                        std::memcpy(out.data(), d.all.data() + offset, out.size());
                        return Read::kDone;
                      },
                      &download, bytes.size()};
  auto asset = Asset::open(source);
  ASSERT_TRUE(asset);
  const Result<void> loaded = (*asset)->loadAll();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kIo);
  EXPECT_GE((*asset)->residentLevel(0), 0) << "what came can be used";
  EXPECT_FALSE(*(*asset)->pump());
  download.there = bytes.size();
  (*asset)->retry();
  ASSERT_TRUE((*asset)->loadAll());
  expectHolds(**asset, test::ballClump({70, 90, 60}, 30, 1));
}

TEST(Asset, LoadAllLoadsWhatNobodyAskedFor) {
  const std::vector<std::byte> bytes = clumpBytes();
  for (const int rounds : {1, 3, 7, 8, 9, 100}) {  // of requests, which age
    MemorySource source(bytes);
    auto asset = Asset::open(source.source());
    ASSERT_TRUE(asset);
    for (int i = 0; i < rounds; ++i) PageAccess::beginRequests(**asset);
    while (*(*asset)->pump()) {
    }
    EXPECT_GT((*asset)->residentLevel(0), 0) << "the coarsest level comes by itself";
    ASSERT_TRUE((*asset)->loadAll());
    EXPECT_EQ((*asset)->residentLevel(0), 0) << rounds;
  }
}

TEST(Asset, AWatchOutlivesIt) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  AssetWatch watch;
  EXPECT_FALSE(watch.alive());
  {
    auto asset = Asset::open(source.source());
    watch = AssetWatch(**asset);
    const AssetWatch copy = watch;
    EXPECT_TRUE(copy.alive());
  }
  EXPECT_FALSE(watch.alive());
}

}  // namespace
}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
#include "kelp/runtime/asset.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "support/test_pack.h"

namespace kelp::runtime {
namespace {

std::vector<std::byte> clumpBytes() { return test::bytesOf(test::packOf(test::ballClump({70, 90, 60}, 30, 1))); }

void expectHolds(const Asset& asset, const fields::Occupancy& volume) {
  const LevelData* level = asset.level(0, 0);
  ASSERT_NE(level, nullptr);
  ASSERT_EQ(level->size, volume.size);
  RawLevel raw;
  raw.cells.assign(level->cells.begin(), level->cells.end());
  raw.codes.assign(level->codes.begin(), level->codes.end());
  EXPECT_EQ(fields::occupancyOf(raw, level->size).solid, volume.solid);
}

TEST(Asset, LoadsWhatWasWritten) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  EXPECT_EQ((*asset)->level(0, 0), nullptr) << "nothing is resident before pump()";
  EXPECT_EQ((*asset)->residentLevel(0), -1);
  ASSERT_TRUE((*asset)->loadAll());
  expectHolds(**asset, test::ballClump({70, 90, 60}, 30, 1));
  EXPECT_EQ((*asset)->residentLevel(0, 1), 1);
  EXPECT_EQ((*asset)->level(0, 99), nullptr);
  EXPECT_EQ((*asset)->level(3, 0), nullptr);
  EXPECT_EQ((*asset)->level(-1, -1), nullptr);
}

TEST(Asset, LevelsArriveCoarseToFine) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  int finest = (*asset)->pack().parts()[0].levels;
  while (true) {
    const Result<bool> more = (*asset)->pump();
    ASSERT_TRUE(more);
    if (!*more) break;
    const int now = (*asset)->residentLevel(0);
    if (now >= 0) {
      EXPECT_LE(now, finest);
      finest = now;
      for (int l = now; l < (*asset)->pack().parts()[0].levels; ++l) EXPECT_NE((*asset)->level(0, l), nullptr);
    }
  }
  EXPECT_EQ(finest, 0);
}

TEST(Asset, AnyNumberOfThreadsMayPump) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  auto asset = Asset::open(source.source());
  ASSERT_TRUE(asset);
  std::atomic<int> errors{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      while ((*asset)->residentLevel(0) != 0 && errors == 0) {
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
  EXPECT_EQ((*asset)->level(0, 0), nullptr);
  EXPECT_EQ((*asset)->residentLevel(0), 1);
  const Result<bool> again = (*asset)->pump();
  ASSERT_TRUE(again);
  EXPECT_FALSE(*again);
}

TEST(Asset, AllocationFailureIsAnErrorEachTime) {
  const std::vector<std::byte> bytes = clumpBytes();
  struct Counter {
    std::int64_t left = 0;
    std::int64_t live = 0;
  };
  int failures = 0;
  for (int n = 0; n < 400; ++n) {
    Counter counter{n, 0};
    Options options;
    options.allocator = {[](void* user, std::size_t size) -> void* {
                           auto& c = *static_cast<Counter*>(user);
                           if (c.left-- <= 0) return nullptr;
                           ++c.live;
                           return std::malloc(size);
                         },
                         [](void* user, void* memory, std::size_t) {
                           --static_cast<Counter*>(user)->live;
                           std::free(memory);
                         },
                         &counter};
    {
      MemorySource source(bytes);
      auto asset = Asset::open(source.source(), options);
      const bool loaded = asset && (*asset)->loadAll();
      if (loaded) n = 400;
      failures += !loaded;
    }
    EXPECT_EQ(counter.live, 0);
  }
  EXPECT_GT(failures, 5);
  EXPECT_LT(failures, 400) << "never loaded";
}

TEST(Asset, ALevelLargerThanTheLimitIsRefused) {
  const std::vector<std::byte> bytes = clumpBytes();
  MemorySource source(bytes);
  Options options;
  options.limits.max_decoded_bytes = 20000;
  auto asset = Asset::open(source.source(), options);
  ASSERT_TRUE(asset);
  const Result<void> loaded = (*asset)->loadAll();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kLimit);
  EXPECT_GT((*asset)->residentLevel(0), 0) << "the coarse levels fit";
}

}  // namespace
}  // namespace kelp::runtime

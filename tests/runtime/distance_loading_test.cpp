// SPDX-License-Identifier: MIT
// Distances in memory: what is loaded when, within which budget, from which source.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <set>

#include "kelp/runtime/asset.h"
#include "kelp/runtime/level.h"
#include "support/all_tests.h"
#include "support/distance_pack.h"

namespace kelp::runtime {
namespace {

const RawPack& dustPack() {
  static const RawPack pack = test::distancePackOf(test::dust({96, 128, 96}, 200, 4));
  return pack;
}
const std::vector<std::byte>& distanceBytes() {
  static const std::vector<std::byte> bytes = test::bytesOf(dustPack());
  return bytes;
}

// A source that counts, hides or refuses what lies between two offsets.
struct Watched {
  std::uint64_t from = 0, to = 0;
  std::atomic<Read> answer{Read::kDone};
  std::atomic<int> reads{0};
  int one_in = 1;  // of the reads between them, one is answered so

  Source source() {
    return {[](void* user, std::uint64_t offset, std::span<std::byte> out) {
              auto& self = *static_cast<Watched*>(user);
              if (offset < self.to && offset + out.size() > self.from) {
                const int read = self.reads++;
                if (self.answer != Read::kDone && read % self.one_in == 0) return self.answer.load();
              }
              std::memcpy(out.data(), distanceBytes().data() + offset, out.size());
              return Read::kDone;
            },
            this, distanceBytes().size(), nullptr, nullptr};
  }
};

// From the first DGRD chunk to the end of the file.
std::uint64_t distancesBegin(const Pack& pack) {
  std::uint64_t first = pack.fileSize();
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    if (chunk.fourcc == ('D' | 'G' << 8 | 'R' << 16 | std::uint32_t{'D'} << 24))
      first = std::min(first, chunk.offset);
  }
  return first;
}
Watched watchDistances() {
  MemorySource memory(distanceBytes());
  return {distancesBegin(*Pack::open(memory.source())), distanceBytes().size()};
}

AssetOptions withDistances(int level = 0) {
  AssetOptions options;
  options.distance_level = level;
  return options;
}

void expectHolds(const Asset& asset, int finest) {
  const std::vector<RawDistances>& truth = dustPack().parts[0].distances;
  for (int level = 0; level < static_cast<int>(truth.size()); ++level) {
    const Level* found = asset.distances(0, level);
    ASSERT_EQ(found != nullptr, level >= finest) << level;
    if (!found) continue;
    const RawDistances& wanted = truth[static_cast<std::size_t>(level)];
    EXPECT_EQ(found->band, wanted.band);
    EXPECT_EQ(found->size, levelSize(dustPack().parts[0].size, level));
    const auto same = [&](std::uint32_t cell, std::uint32_t as_written) {
      if (!(cell & kCellSolid)) return cell == as_written;
      return (kCellSolid | (found->first_slots[cellPage(cell)] + cellBrick(cell))) == as_written;
    };
    EXPECT_TRUE(
        std::equal(found->cells.begin(), found->cells.end(), wanted.cells.begin(), wanted.cells.end(), same))
        << level;
    EXPECT_TRUE(
        std::equal(found->codes.begin(), found->codes.end(), wanted.codes.begin(), wanted.codes.end()))
        << level;
  }
}

TEST(DistanceLoading, NothingIsReadUnasked) {
  Watched watched = watchDistances();
  const auto asset = Asset::open(watched.source()).value();
  ASSERT_TRUE(asset->loadAll());
  EXPECT_EQ(watched.reads, 0);
  EXPECT_EQ(asset->residentLevel(0), 0);
  EXPECT_EQ(asset->distances(0, 0), nullptr);
}

TEST(DistanceLoading, HoldsWhatWasWritten) {
  MemorySource source(distanceBytes());
  const int levels = Pack::open(source.source())->distanceLevels(0);
  for (const int finest : {0, 1, 3, levels - 1, levels + 5}) {
    const auto asset = Asset::open(source.source(), withDistances(finest)).value();
    ASSERT_TRUE(asset->loadAll());
    expectHolds(*asset, std::min(finest, levels - 1));
    for (const int part : {-1, 1, 99}) EXPECT_EQ(asset->distances(part, 0), nullptr);
    for (const int level : {-1, levels, 99}) EXPECT_EQ(asset->distances(0, level), nullptr);
  }
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(test::dust({20, 20, 20}, 20, 1)));
  MemorySource without(bytes);
  const auto asset = Asset::open(without.source(), withDistances()).value();
  EXPECT_TRUE(asset->loadAll());
  EXPECT_EQ(asset->distances(0, 0), nullptr);
}

// After the coarsest voxels, before the finest; coarse to fine.
TEST(DistanceLoading, ComesInOrder) {
  MemorySource source(distanceBytes());
  const auto asset = Asset::open(source.source(), withDistances()).value();
  int finest = asset->pack().distanceLevels(0);
  while (*asset->pump()) {
    for (int level = 0; level < asset->pack().distanceLevels(0); ++level) {
      if (!asset->distances(0, level)) continue;
      EXPECT_GE(asset->residentLevel(0), 0);
      EXPECT_GE(level, finest - 1);
      finest = std::min(finest, level);
    }
    if (asset->residentLevel(0) >= 0 && asset->residentLevel(0) < asset->pack().parts()[0].levels - 1) {
      EXPECT_EQ(finest, 0);
    }
  }
  expectHolds(*asset, 0);
}

TEST(DistanceLoading, StaysWithinTheBudget) {
  MemorySource source(distanceBytes());
  const auto all = Asset::open(source.source(), withDistances()).value();
  ASSERT_TRUE(all->loadAll());
  std::set<int> seen;
  for (int share = 1; share <= 40; share += test::kSanitized ? 3 : 1) {
    AssetOptions options = withDistances();
    options.memory_budget = all->memory() * static_cast<std::uint64_t>(share) / 38;
    const auto asset = Asset::open(source.source(), options).value();
    for (int i = 0; i < 20; ++i) {  // rounds pass: what is idle goes, distances stay
      while (*asset->pump()) ASSERT_LE(asset->memory(), options.memory_budget);
    }
    int finest = 0;
    while (!asset->distances(0, finest)) ++finest;
    seen.insert(finest);
    expectHolds(*asset, finest);
    const Result<void> loaded = asset->loadAll();
    ASSERT_EQ(static_cast<bool>(loaded), share >= 38) << share;
    EXPECT_TRUE(loaded || loaded.error().code == ErrorCode::kLimit);
  }
  EXPECT_GT(seen.size(), 2u);
}

TEST(DistanceLoading, WaitsForItsSource) {
  Watched watched = watchDistances();
  watched.answer = Read::kNotYet;
  watched.one_in = 2;
  const auto asset = Asset::open(watched.source(), withDistances()).value();
  int passes = 0;
  while (true) {
    while (true) {
      const Result<bool> more = asset->pump();
      ASSERT_TRUE(more) << more.error().detail;
      if (!*more) break;
    }
    EXPECT_EQ(asset->residentLevel(0), 0) << "voxels do not wait for distances";
    const Result<void> all = asset->loadAll();
    if (all) break;
    EXPECT_EQ(all.error().code, ErrorCode::kNotYet);
    ASSERT_LT(++passes, 1000);
  }
  EXPECT_GT(passes, 2);
  expectHolds(*asset, 0);
}

TEST(DistanceLoading, FailsOnceAndTriesAgain) {
  Watched watched = watchDistances();
  watched.answer = Read::kFailed;
  const auto asset = Asset::open(watched.source(), withDistances()).value();
  int errors = 0;
  for (int i = 0; i < 2000; ++i) {
    const Result<bool> more = asset->pump();
    if (more) continue;
    ++errors;
    EXPECT_EQ(more.error().code, ErrorCode::kIo);
  }
  EXPECT_EQ(errors, asset->pack().distanceLevels(0)) << "one for each grid";
  EXPECT_EQ(asset->residentLevel(0), 0);
  EXPECT_FALSE(asset->loadAll());
  watched.answer = Read::kDone;
  asset->retry();
  EXPECT_TRUE(asset->loadAll());
  expectHolds(*asset, 0);
}

TEST(DistanceLoading, ADamagedPageLeavesTheOtherLevels) {
  std::vector<std::byte> bytes = distanceBytes();
  bytes[bytes.size() - 100] ^= std::byte{1};  // in the last page of level 0
  MemorySource source(bytes);
  const auto asset = Asset::open(source.source(), withDistances()).value();
  const Result<void> loaded = asset->loadAll();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kChecksum);
  EXPECT_EQ(asset->residentLevel(0), 0);
  expectHolds(*asset, 1);
}

}  // namespace
}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// Sources that answer "not yet": a network, a slow archive. Nothing fails, nothing blocks, nothing spins, and
// in the end everything is there.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "loaded.h"
#include "support/all_tests.h"

namespace kelp::runtime {
namespace {

const std::vector<std::byte>& slowDustBytes() {
  static const std::vector<std::byte> bytes = test::bytesOf(test::packOf(test::dust({96, 128, 96}, 40, 4)));
  return bytes;
}

// Ranges that were asked for arrive later, each after some ticks of its own, in any order. Some are lost and
// have to be asked for again.
class SlowSource {
 public:
  SlowSource(const std::vector<std::byte>& bytes, unsigned seed, unsigned slowest)
      : bytes_(bytes), random_(seed), slowest_(slowest) {}

  Source source() { return {&SlowSource::read, this, bytes_.size(), nullptr, nullptr}; }
  void tick() { ++now_; }
  std::size_t reads() const { return reads_; }
  std::size_t refused() const { return refused_; }
  bool everything_is_there = false;

 private:
  static Read read(void* user, std::uint64_t offset, std::span<std::byte> out) {
    auto& self = *static_cast<SlowSource*>(user);
    ++self.reads_;
    if (!self.everything_is_there && !self.hasArrived(offset, out.size())) {
      ++self.refused_;
      std::fill(out.begin(), out.end(), std::byte{0xEE});  // unspecified content
      return Read::kNotYet;
    }
    std::memcpy(out.data(), self.bytes_.data() + offset, out.size());
    return Read::kDone;
  }
  bool hasArrived(std::uint64_t offset, std::size_t size) {
    const auto [range, is_new] = arrives_.try_emplace({offset, size}, now_ + random_() % (slowest_ + 1));
    if (is_new && random_() % 8 == 0) arrives_.erase(range);  // lost on the way
    const auto found = arrives_.find({offset, size});
    return found != arrives_.end() && now_ >= found->second;
  }

  const std::vector<std::byte>& bytes_;
  std::mt19937 random_;
  unsigned slowest_;
  std::uint64_t now_ = 0;
  std::size_t reads_ = 0, refused_ = 0;
  std::map<std::pair<std::uint64_t, std::size_t>, std::uint64_t> arrives_;
};

// Grids and pages of an asset.
std::size_t thingsOf(const Asset& asset) {
  std::size_t things = 0;
  for (int level = 0; level < asset.pack().parts()[0].levels; ++level) {
    const Level* of = asset.level(0, level);
    things += 1 + (of ? of->pages.size() : 0);
  }
  return things;
}

void expectSameVoxels(const Asset& asset, const Asset& truth) {
  for (int level = 0; level < truth.pack().parts()[0].levels; ++level) {
    ASSERT_TRUE(asset.level(0, level)) << level;
    const Level& mine = *asset.level(0, level);
    const Level& theirs = *truth.level(0, level);
    ASSERT_TRUE(std::equal(mine.cells.begin(), mine.cells.end(), theirs.cells.begin(), theirs.cells.end()));
    for (std::uint32_t page = 0; page < theirs.pages.size(); ++page) {
      const PinnedPage a = PageAccess::pin(asset, {0, level}, page, 1),
                       b = PageAccess::pin(truth, {0, level}, page, 1);
      ASSERT_TRUE(a && b) << level << " " << page;
      ASSERT_TRUE(std::equal(a.words().begin(), a.words().end(), b.words().begin(), b.words().end()));
    }
  }
}

std::unique_ptr<Asset> openSlowly(SlowSource& slow) {
  for (int tick = 0; tick < 10'000; ++tick, slow.tick()) {
    auto opened = Asset::open(slow.source());
    if (opened) return *std::move(opened);
    EXPECT_EQ(opened.error().code, ErrorCode::kNotYet) << opened.error().detail;
  }
  ADD_FAILURE() << "it never opens";
  return nullptr;
}

TEST(WaitingSource, EverythingComesInAnyOrder) {
  Loaded truth(test::packOf(test::dust({96, 128, 96}, 40, 4)));
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    SlowSource slow(slowDustBytes(), seed, seed == 0 ? 0 : 1u << (seed % 6));
    const std::unique_ptr<Asset> asset = openSlowly(slow);
    ASSERT_TRUE(asset);
    int passes = 0;
    while (asset->residentLevel(0) != 0) {
      ASSERT_LT(++passes, 5'000) << "it never ends";
      const std::size_t refused = slow.refused();
      while (true) {
        const Result<bool> more = asset->pump();
        ASSERT_TRUE(more) << more.error().detail;
        if (!*more) break;
      }
      // Each thing is asked for once in a pass: no busy loop.
      ASSERT_LE(slow.refused() - refused, thingsOf(*asset));
      slow.tick();
    }
    EXPECT_GT(passes, seed == 0 ? 1 : 4);
    EXPECT_GT(slow.refused(), seed == 0 ? 2u : 20u);
    expectSameVoxels(*asset, *truth.asset);
  }
}

// Pages that have arrived are loaded before more urgent ones that have not, unless they are decoded with
// these.
TEST(WaitingSource, WhatIsThereGoesOn) {
  SlowSource slow(slowDustBytes(), 1, 1);
  slow.everything_is_there = true;
  const std::unique_ptr<Asset> asset = openSlowly(slow);
  ASSERT_TRUE(asset->loadAll());
  struct Half {
    SlowSource& all;
    std::uint64_t hidden_from, hidden_to;
    std::mutex one_at_a_time = {};  // SlowSource is not for several threads
  };
  const std::span<const PageInfo> pages = asset->level(0, 1)->pages;
  ASSERT_GT(pages.size(), 2u);
  Half half{slow, pages[0].offset, pages[0].offset + pages[0].stored};
  const Source source{[](void* user, std::uint64_t offset, std::span<std::byte> out) {
                        Half& self = *static_cast<Half*>(user);
                        const std::lock_guard lock(self.one_at_a_time);
                        if (offset < self.hidden_to && offset + out.size() > self.hidden_from)
                          return Read::kNotYet;
                        const Source inner = self.all.source();
                        return inner.read(inner.user, offset, out);
                      },
                      &half, slowDustBytes().size(), nullptr, nullptr};
  const auto waiting = Asset::open(source).value();
  const std::size_t before = slow.reads();
  for (int pass = 0; pass < 3; ++pass) {
    while (*waiting->pump()) continue;
  }
  EXPECT_GT(slow.reads() - before, 5u);
  ASSERT_TRUE(waiting->level(0, 0)) << "every grid is there";
  EXPECT_EQ(waiting->residentLevel(0), 2);
  const auto last = static_cast<std::uint32_t>(waiting->level(0, 0)->pages.size() - 1);
  EXPECT_TRUE(PageAccess::pin(*waiting, {0, 0}, last, 1)) << "far from the page that waits";
  EXPECT_FALSE(PageAccess::pin(*waiting, {0, 0}, 0, 1)) << "below it";

  // No thread takes what it did not get for loaded.
  for (int repeat = 0; test::kThreads && repeat < 20; ++repeat) {
    std::vector<std::thread> loaders;
    for (int i = 0; i < 3; ++i)
      loaders.emplace_back([&] {
        const Result<void> all = waiting->loadAll();
        ASSERT_FALSE(all);
        EXPECT_EQ(all.error().code, ErrorCode::kNotYet);
      });
    for (std::thread& loader : loaders) loader.join();
  }
  half.hidden_to = 0;
  EXPECT_TRUE(waiting->loadAll());
  EXPECT_EQ(waiting->residentLevel(0), 0);
}

// While a caller reads, another ends the pass: what the first did not get stays behind, waiting. It is asked
// for again before loadAll() says that the source has not got it.
TEST(WaitingSource, WhatWaitedForAnotherCallerIsAskedForAgain) {
  struct Once {
    MemorySource memory{slowDustBytes()};
    std::uint64_t page = ~std::uint64_t{0};
    Asset* asset = nullptr;
    bool asked = false;
  } once;
  const Source source{[](void* user, std::uint64_t offset, std::span<std::byte> out) {
                        Once& self = *static_cast<Once*>(user);
                        if (offset == self.page && !std::exchange(self.asked, true)) {
                          while (*self.asset->pump()) continue;
                          return Read::kNotYet;
                        }
                        const Source all = self.memory.source();
                        return all.read(all.user, offset, out);
                      },
                      &once, slowDustBytes().size(), nullptr, nullptr};
  const auto asset = Asset::open(source).value();
  once.asset = asset.get();
  while (!asset->level(0, 1)) ASSERT_TRUE(*asset->pump());
  once.page = asset->level(0, 1)->pages[0].offset;
  while (*asset->pump()) continue;
  ASSERT_TRUE(once.asked);
  EXPECT_TRUE(asset->loadAll());
  EXPECT_EQ(asset->residentLevel(0), 0);
}

}  // namespace
}  // namespace kelp::runtime

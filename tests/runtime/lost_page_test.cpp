// SPDX-License-Identifier: MIT
// A coarse page that never comes, or is damaged: what can be decoded without it is loaded all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "kelp/formats/level.h"
#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "loaded.h"
#include "support/poses.h"

namespace kelp::runtime {
namespace {

const std::vector<std::byte>& finelyDividedBytes() {
  static const std::vector<std::byte> bytes = test::bytesOf(test::packOf(test::dust({768, 128, 128}, 40, 4)));
  return bytes;
}

// Which pages of levels 0 to 2 can be decoded without one page of level 2: those of whose coarser pages none
// is lost. beside: a page beside is needed as well as one above.
std::vector<std::vector<bool>> decodable(const Pack& pack, std::uint32_t lost, bool beside) {
  std::vector<LevelGrid> grids;
  for (int level = 0; level < 3; ++level) grids.push_back(std::move(*pack.readGrid(0, level)));
  std::vector<std::vector<bool>> can(3);
  can[2].assign(grids[2].pages.size(), true);
  if (lost < can[2].size()) can[2][lost] = false;
  for (std::size_t level = 2; level-- > 0;) {
    PagesAbove needs;
    EXPECT_TRUE(needs.make(grids[level], grids[level + 1]));
    for (std::size_t page = 0; page < grids[level].pages.size(); ++page) {
      bool all = true;
      for (const std::uint32_t coarser : needs.of(page))
        all = all && (can[level + 1][coarser] ||
                      (!beside && !PagesAbove::isOver(grids[level], page, grids[level + 1], coarser)));
      can[level].push_back(all);
    }
  }
  return can;
}

std::size_t countOf(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

void expectLoaded(const Asset& asset, const std::vector<std::vector<bool>>& wanted) {
  for (int level = 0; level < 3; ++level) {
    const std::vector<bool>& of = wanted[static_cast<std::size_t>(level)];
    for (std::uint32_t page = 0; page < of.size(); ++page)
      EXPECT_EQ(static_cast<bool>(PageAccess::pin(asset, {0, level}, page, 1)), of[page])
          << level << " " << page;
  }
}

// Answers for one range: it has not come, or cannot be read.
struct Without {
  std::uint64_t lost = ~std::uint64_t{0};
  Read answer = Read::kNotYet;

  Source source() {
    return {[](void* user, std::uint64_t offset, std::span<std::byte> out) {
              const Without& self = *static_cast<const Without*>(user);
              if (offset == self.lost) return self.answer;
              std::memcpy(out.data(), finelyDividedBytes().data() + offset, out.size());
              return Read::kDone;
            },
            this, finelyDividedBytes().size()};
  }
};

TEST(LostPage, OneThatIsLateHoldsUpOnlyWhatNeedsIt) {
  Without without;
  auto asset = *Asset::open(without.source());
  without.lost = asset->pack().readGrid(0, 2)->pages[1].offset;
  const auto wanted = decodable(asset->pack(), 1, true);
  const auto pages = static_cast<std::uint32_t>(wanted[0].size());
  ASSERT_GT(pages - countOf(wanted[0]), 64u) << "more wait than are kept in mind";
  ASSERT_GT(countOf(wanted[0]), 64u);
  for (int round = 0; round < 6; ++round) {
    PageAccess::beginRequests(*asset);
    for (int level = 0; level < asset->pack().parts()[0].levels; ++level)
      PageAccess::request(*asset, {0, level}, 1);
    // The page that waits is the most urgent.
    for (std::uint32_t page = 0; page < pages && asset->level(0, 0); ++page)
      (void)PageAccess::pin(*asset, {0, 0}, page, wanted[0][page] ? 1.0f : 2.0f);
    while (*asset->pump()) {
    }
  }
  for (std::uint32_t page = 0; page < pages; ++page)
    EXPECT_EQ(static_cast<bool>(PageAccess::pin(*asset, {0, 0}, page, 1)), wanted[0][page]) << page;
  without.lost = 0;
  ASSERT_TRUE(asset->loadAll());
}

TEST(LostPage, OneThatIsDamagedCostsWhatLiesBelowIt) {
  Without without;
  auto asset = *Asset::open(without.source());
  without.lost = asset->pack().readGrid(0, 2)->pages[1].offset;
  without.answer = Read::kFailed;
  const auto wanted = decodable(asset->pack(), 1, false);
  ASSERT_GT(countOf(wanted[0]), countOf(decodable(asset->pack(), 1, true)[0]));
  const Result<void> loaded = asset->loadAll();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kIo);
  expectLoaded(*asset, wanted);

  // Their voxels are right, though their boxes end earlier.
  MemorySource memory(finelyDividedBytes());
  auto truth = *Asset::open(memory.source());
  ASSERT_TRUE(truth->loadAll());
  bool any_shorter = false;
  const std::span<const PageInfo> infos = truth->level(0, 0)->pages;
  for (std::uint32_t page = 0; page < infos.size(); ++page) {
    if (!wanted[0][page]) continue;
    const PinnedPage a = PageAccess::pin(*asset, {0, 0}, page, 1),
                     b = PageAccess::pin(*truth, {0, 0}, page, 1);
    for (std::uint32_t voxel = 0; voxel < infos[page].count * kBrickVoxels; ++voxel) {
      const std::uint32_t brick = kBrickWords * (voxel / kBrickVoxels);
      const auto at = static_cast<int>(voxel % kBrickVoxels);
      const glm::ivec3 v(at & 7, at >> 3 & 7, at >> 6);
      const std::uint8_t mine = codeOf(a.words().data() + brick, v),
                         its = codeOf(b.words().data() + brick, v);
      ASSERT_EQ(isSolidCode(mine), isSolidCode(its));
      if (isSolidCode(mine)) {
        ASSERT_EQ(mine, its);
      } else {
        any_shorter = any_shorter || mine != its;
      }
    }
  }
  EXPECT_TRUE(any_shorter);

  without.lost = 0;
  asset->retry();
  ASSERT_TRUE(asset->loadAll());
  expectLoaded(*asset, decodable(asset->pack(), ~0u >> 1, false));
}

}  // namespace
}  // namespace kelp::runtime

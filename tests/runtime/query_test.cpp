// SPDX-License-Identifier: MIT
// Rays into an asset that has too little memory: they meet what is there, ask for what is not, and get it.
#include <gtest/gtest.h>

#include <random>

#include "kelp/runtime/instance.h"
#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "loaded.h"
#include "support/edit_knots.h"
#include "support/voxel_points.h"

namespace kelp::runtime {
namespace {

// Of many pages at level 0.
const std::vector<std::byte>& dustBytes() {
  static const std::vector<std::byte> bytes = test::bytesOf(test::packOf(test::dust({128, 160, 128}, 40, 4)));
  return bytes;
}

std::uint64_t memoryOfAll(std::span<const std::byte> bytes) {
  MemorySource source(bytes);
  const auto asset = Asset::open(source.source());
  EXPECT_TRUE((*asset)->loadAll());
  return (*asset)->memory();
}

TEST(Query, RaysBringWhatTheyLackIntoAQuarterOfTheMemory) {
  const std::uint64_t all = memoryOfAll(dustBytes());
  Loaded whole(test::packOf(test::dust({128, 160, 128}, 40, 4)));
  MemorySource source(dustBytes());
  AssetOptions options;
  options.memory_budget = all / 4;
  auto opened = Asset::open(source.source(), options);
  ASSERT_TRUE(opened);
  Asset& asset = **opened;
  (void)asset.loadAll();
  ASSERT_LE(asset.memory(), options.memory_budget);
  Pose pose = *Pose::create(asset);
  test::edit(pose, 0, 40)[1].position.x += 30;
  Pose same = *Pose::create(*whole.asset);
  test::edit(same, 0, 40)[1].position.x += 30;
  const Instance instance{&asset, &pose};
  const Instance truth{whole.asset.get(), &same};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  int coarse = 0;
  for (int place = 0; place < 40; ++place) {
    Ray ray;
    ray.origin = {2.0f * unit(random) - 1, unit(random), 2};
    ray.direction =
        test::voxelToWorld(instance, 0, {128 * unit(random), 160 * unit(random), 128 * unit(random)}) -
        ray.origin;
    const auto wanted = raycast(truth, ray);
    bool fine = false;
    for (int tick = 0; tick < 40 && !fine; ++tick) {
      const auto hit = raycast(instance, ray);
      EXPECT_EQ(hit.has_value() || !wanted, true) << "a coarser voxel is solid where a finer one is";
      if (hit && wanted) {
        EXPECT_LE(hit->t, wanted->t + 1e-4f) << "a coarser voxel begins no later";
      }
      coarse += hit && hit->level > 0;
      while (true) {
        const auto more = asset.pump();
        ASSERT_TRUE(more);
        if (!*more) break;
      }
      EXPECT_LE(asset.memory(), options.memory_budget);
      fine = wanted ? hit && hit->level == 0 && hit->voxel == wanted->voxel &&
                          std::abs(hit->t - wanted->t) < 1e-4f
                    : !hit;
    }
    EXPECT_TRUE(fine) << "what the ray asked for never came, place " << place;
  }
  EXPECT_GT(coarse, 20) << "too little was missing to tell";
}

TEST(Query, PinnedPagesStay) {
  const std::uint64_t all = memoryOfAll(dustBytes());
  MemorySource source(dustBytes());
  AssetOptions options;
  options.memory_budget = all / 2;
  auto opened = Asset::open(source.source(), options);
  ASSERT_TRUE(opened);
  Asset& asset = **opened;
  (void)asset.loadAll();
  const auto pages = static_cast<std::uint32_t>(asset.level(0, 0)->pages.size());
  std::vector<PinnedPage> kept;
  std::vector<std::vector<std::uint32_t>> words;
  std::vector<std::uint32_t> which;
  for (std::uint32_t page = 0; page < pages && kept.size() < 3; ++page) {
    PinnedPage pinned = PageAccess::pin(asset, {0, 0}, page, 1);
    if (!pinned) continue;
    words.emplace_back(pinned.words().begin(), pinned.words().end());
    which.push_back(page);
    kept.push_back(std::move(pinned));
  }
  ASSERT_EQ(kept.size(), 3u);
  // All others are asked for in turn, long enough for each of them to come, and to go.
  std::vector<bool> came(pages);
  for (int round = 0; round < 600; ++round) {
    PageAccess::beginRequests(asset);
    const std::uint32_t page = static_cast<std::uint32_t>(round / 10) % pages;
    if (std::find(which.begin(), which.end(), page) == which.end() && PageAccess::pin(asset, {0, 0}, page, 1))
      came[page] = true;
    while (*asset.pump()) {
    }
    EXPECT_LE(asset.memory(), options.memory_budget);
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_TRUE(std::equal(words[i].begin(), words[i].end(), kept[i].words().begin(), kept[i].words().end()));
    const PinnedPage again = PageAccess::pin(asset, {0, 0}, which[i], 1);
    ASSERT_TRUE(again);
    EXPECT_EQ(again.words().data(), kept[i].words().data()) << "it is the same one";
    came[which[i]] = true;
  }
  EXPECT_EQ(std::count(came.begin(), came.end(), false), 0);
}

// All of a part, at most `finest` fine, and what of it is there is looked at.
void askFor(const Asset& asset, int part, int finest, float urgency) {
  for (int level = asset.pack().parts()[static_cast<std::size_t>(part)].levels - 1; level >= finest;
       --level) {
    PageAccess::request(asset, {part, level}, urgency);
    const Level* data = asset.level(part, level);
    for (std::uint32_t page = 0; data && page < data->pages.size(); ++page)
      (void)PageAccess::pin(asset, {part, level}, page, urgency);
  }
}
void pumpAll(Asset& asset) {
  while (true) {
    const auto more = asset.pump();
    if (more && !*more) return;
  }
}

// A level that is asked for most urgently, and for which there is no room, must not keep smaller things from
// coming.
TEST(Query, WhatDoesNotFitHoldsUpNobody) {
  RawPack pack = test::packOf(test::dust({800, 8, 800}, 20000, 3));  // a large grid
  pack.parts.push_back(
      test::partOf(test::ballClump({12, 12, 12}, 4, 3), test::figureKnots(test::kFigure6[0]), "small"));
  const std::vector<std::byte> bytes = test::bytesOf(pack);
  std::uint64_t small = 0;
  {
    MemorySource source(bytes);
    auto asset = Asset::open(source.source());
    for (int round = 0; round < 20; ++round) {
      PageAccess::beginRequests(**asset);
      askFor(**asset, 0, 1, 50);
      askFor(**asset, 1, 0, 1);
      pumpAll(**asset);
    }
    ASSERT_EQ((*asset)->residentLevel(0), 1);
    ASSERT_EQ((*asset)->residentLevel(1), 0);
    small = (*asset)->memory();
  }
  MemorySource source(bytes);
  AssetOptions options;
  options.memory_budget = small + 4096;
  auto opened = Asset::open(source.source(), options);
  ASSERT_TRUE(opened);
  Asset& asset = **opened;
  for (int round = 0; round < 40; ++round) {
    PageAccess::beginRequests(asset);
    askFor(asset, 0, 1, 50);
    if (round >= 20) {
      PageAccess::request(asset, {0, 0}, 100);
      askFor(asset, 1, 0, 1);
    }
    pumpAll(asset);
    EXPECT_LE(asset.memory(), options.memory_budget);
  }
  EXPECT_EQ(asset.level(0, 0), nullptr) << "it fits, so this tells nothing";
  EXPECT_EQ(asset.residentLevel(1), 0);
}

}  // namespace
}  // namespace kelp::runtime

// SPDX-License-Identifier: MIT
// The planner where a host errs, or nothing fits: no copy is lost, and none is of what is gone.
#include "kelp/draw/planner.h"

#include <algorithm>

#include "crowd.h"

namespace kelp::test {
namespace {

std::unique_ptr<draw::Planner> planner(std::uint64_t pool_bytes = kTinyPool) {
  auto made = draw::Planner::create({.pool_bytes = pool_bytes}).value();
  EXPECT_EQ(made->copies().size(), 1u);  // the solid brick
  made->copied();
  return made;
}

// An asset that is complete.
std::unique_ptr<runtime::Asset> loaded(const MemorySource& source) {
  auto asset = runtime::Asset::open(source.source()).value();
  EXPECT_TRUE(asset->loadAll());
  return asset;
}

class PlannerTest : public testing::Test {
 protected:
  std::vector<std::byte> bytes_ = bytesOf(packOf(ballClump({60, 80, 50}, 20, 2)));
  MemorySource source_{bytes_};
};

TEST_F(PlannerTest, CopiesThatAreNotMadeAreMisuse) {
  const auto one = planner();
  const auto first = loaded(source_), second = loaded(source_);
  ASSERT_TRUE(one->add(*first));
  ASSERT_EQ(one->copies().size(), 1u);
  EXPECT_EQ(one->add(*second).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(one->upload(1 << 20).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(one->copies().size(), 1u) << "they are still there";
  one->copied();
  EXPECT_TRUE(one->copies().empty());
  EXPECT_TRUE(one->add(*second));
}

TEST_F(PlannerTest, RemovingAnAssetLeavesTheCopiesOfOthers) {
  const auto one = planner(std::uint64_t{8} << 20);
  const auto first = loaded(source_), second = loaded(source_);
  for (const auto* asset : {first.get(), second.get()}) {
    ASSERT_TRUE(one->add(*asset));
    one->copied();
  }
  ASSERT_EQ(one->upload(~std::uint64_t{0}).value().pending, 0u);
  const std::size_t both = one->copies().size();
  one->remove(*second);
  EXPECT_EQ(one->copies().size(), both / 2);
  // They are those that the planner of the first alone wants.
  const auto alone = planner(std::uint64_t{8} << 20);
  ASSERT_TRUE(alone->add(*first));
  alone->copied();
  ASSERT_TRUE(alone->upload(~std::uint64_t{0}));
  std::vector<std::vector<std::uint32_t>> left, expected;
  const auto pages = [](const draw::Planner& of, std::vector<std::vector<std::uint32_t>>& to) {
    for (const draw::Copy& copy : of.copies())
      if (copy.words.size() > 200) to.emplace_back(copy.words.begin(), copy.words.end());
    std::sort(to.begin(), to.end());
  };
  pages(*one, left);
  pages(*alone, expected);
  EXPECT_EQ(left, expected);
}

TEST_F(PlannerTest, AnAssetThatIsGoneIsForgotten) {
  const auto one = planner();
  auto gone = loaded(source_);
  ASSERT_TRUE(one->add(*gone));
  one->copied();
  ASSERT_TRUE(one->upload(~std::uint64_t{0}));
  EXPECT_GT(one->copies().size(), 1u);
  const std::uint64_t held = one->stats().gpu_bytes;
  gone.reset();
  EXPECT_TRUE(one->copies().empty()) << "their words are gone";
  const auto next = loaded(source_);
  ASSERT_TRUE(one->add(*next));  // needs what the other had
  one->copied();
  ASSERT_TRUE(one->upload(~std::uint64_t{0}));
  EXPECT_EQ(one->stats().gpu_bytes, held);
}

TEST_F(PlannerTest, WhatFitsIsCopiedThoughNotAllDoes) {
  // Tables of all are in the pool, and coarsest levels of some.
  const auto one = planner(std::uint64_t{256} << 10);
  std::vector<std::unique_ptr<runtime::Asset>> assets;
  std::vector<Instance> instances;
  for (int i = 0; i < 30; ++i) {
    assets.push_back(loaded(source_));
    ASSERT_TRUE(one->add(*assets.back())) << i;
    one->copied();
    instances.push_back({assets.back().get()});
  }
  EXPECT_EQ(one->upload(~std::uint64_t{0}).error().code, ErrorCode::kLimit);
  EXPECT_GT(one->copies().size(), 10u);
  one->copied();
  const auto data = one->draw(lookFrom({0, 0.5f, 3}, {0, 0.5f, 0}), instances);
  ASSERT_TRUE(data);
  EXPECT_GT(data->stats.instances, 5u);
  EXPECT_EQ(data->stats.instances + data->stats.waiting, 30u);
}

// The faces of a cage are drawn; its bounds, where the eye is in them or the near plane cuts solid without
// cells.
TEST_F(PlannerTest, PartsWithCagesHaveCallsOfTheirOwn) {
  using draw::Program;
  const fields::Occupancy volume = ballClump({60, 80, 50}, 20, 2);
  const std::vector<std::byte> bytes = bytesOf(cagedPackOf(volume, 8)),
                               small = bytesOf(cagedPackOf(volume, 2));
  const MemorySource source(bytes), small_source(small);
  const auto plain = loaded(source_), with = loaded(source), finer = loaded(small_source);
  const auto one = planner(std::uint64_t{8} << 20);
  for (const auto* asset : {plain.get(), with.get(), finer.get()}) {
    ASSERT_TRUE(one->add(*asset));
    one->copied();
  }
  EXPECT_EQ(one->programs(*plain), 1u);
  EXPECT_EQ(one->programs(*with), 1u | 1u << 2 | 1u << 3);
  ASSERT_EQ(one->upload(~std::uint64_t{0}).value().pending, 0u);
  one->copied();
  const auto facesOf = [](const runtime::Asset& asset) { return asset.pack().parts()[0].cages[0].faces(); };
  ASSERT_GT(facesOf(*finer), 4 * facesOf(*with));

  std::vector<Instance> instances;
  for (int i = 0; i < 5; ++i) {
    instances.push_back({i == 0 ? plain.get() : i == 4 ? finer.get() : with.get()});
    instances.back().to_world[3].z = -static_cast<float>(i);
  }
  draw::View view = lookFrom({0.3f, 0.5f, 3}, {0, 0.5f, 0});
  view.quality.pixels_per_voxel = 0;
  const auto drawn = one->draw(view, instances);
  ASSERT_TRUE(drawn);
  ASSERT_EQ(drawn->calls.size(), 3u);
  const auto expectCall = [&](std::size_t i, Program program, std::uint32_t first, std::uint32_t count,
                              std::uint32_t vertices) {
    const draw::Call& call = drawn->calls[i];
    EXPECT_EQ(call.program, program);
    EXPECT_EQ(call.first, first);
    EXPECT_EQ(call.count, count);
    EXPECT_EQ(call.vertices, vertices);
  };
  expectCall(0, Program::kSheared, 0, 1, 6);
  expectCall(1, Program::kCaged, 1, 3, 3 * facesOf(*with));
  expectCall(2, Program::kCaged, 4, 1, 3 * facesOf(*finer));

  const auto programOf = [&](const draw::View& of, std::size_t instance = 1) {
    const auto data = one->draw(of, instances[instance]);
    EXPECT_EQ(data->calls.size(), 1u);
    return data->calls[0].program;
  };
  EXPECT_EQ(programOf(view), Program::kCaged);
  EXPECT_EQ(programOf(lookFrom({0, 0.5f, -0.8f}, {0, 0.5f, -2})), Program::kAnyBend);
  draw::View cut = view;
  cut.camera.eye_to_clip = glm::perspective(0.8f, 4.0f / 3, 3.9f, 100.0f);
  EXPECT_EQ(programOf(cut), Program::kCaged) << "the near plane cuts cells alone";
  cut.camera.eye_to_clip = glm::perspective(0.8f, 4.0f / 3, 7.0f, 100.0f);
  EXPECT_EQ(programOf(cut, 4), Program::kAnyBend) << "the near plane cuts solid without cells";
  cut.camera.eye_to_clip = glm::perspective(0.8f, 4.0f / 3, 2.0f, 4.0f);
  EXPECT_EQ(programOf(cut), Program::kCaged) << "the far plane cuts it";
  cut.debug = draw::DebugView::kLevels;
  EXPECT_EQ(programOf(cut), Program::kDebug | Program::kAnyBend);
}

}  // namespace
}  // namespace kelp::test

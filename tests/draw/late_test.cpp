// SPDX-License-Identifier: MIT
// A backend that copies late, or not at all, shows coarser voxels or nothing, and every draw ends.
#include <deque>
#include <random>

#include "crowd.h"
#include "kelp/streaming/page_access.h"

namespace kelp::test {
namespace {

bool isSolid(const runtime::Asset& whole, const Seen& seen) {
  const runtime::LevelId id{seen.part, seen.level, false};
  const runtime::Level* const level = runtime::PageAccess::level(whole, id);
  const glm::ivec3 brick = seen.voxel / 8;
  const auto at = static_cast<std::size_t>(brick.x + level->grid.x * (brick.y + level->grid.y * brick.z));
  const std::uint32_t cell = level->cells[at];
  if (cell < 0x80000000u) return false;
  const std::uint32_t page = cell >> 7 & 0x1ffffu;
  if (page == level->pages.size()) return true;
  const runtime::PinnedPage words = runtime::PageAccess::pin(whole, id, page, 1);
  const std::uint8_t code = codeOf(words.words().data() + kBrickWords * (cell & 127u), seen.voxel);
  return code >= 64 && code <= 128;
}

// Copies `late` calls later, in order, into a pool of zeros.
TEST(LateUpload, LateCopiesShowCoarserVoxelsOrNothing) {
  const StreamedPack pack(packOf(ballClump({60, 80, 50}, 20, 2)));
  const Instance instance{pack.streamed.get()};
  const draw::View view = lookFrom({0.5f, 0.8f, 1.1f}, {0, 0.5f, 0});
  std::vector<Seen> truth;
  for (const std::size_t late : {0u, 1u, 3u, 8u}) {
    SCOPED_TRACE(late);
    const auto planner = draw::Planner::create({.pool_bytes = kTinyPool}).value();
    CpuBackend backend(kTinyPool, draw::Features::kNone, 0);
    std::deque<std::vector<std::pair<std::uint64_t, std::vector<std::uint32_t>>>> calls;
    const auto take = [&] {
      auto& call = calls.emplace_back();
      for (const draw::Copy& copy : planner->copies())
        call.emplace_back(copy.offset, std::vector(copy.words.begin(), copy.words.end()));
      planner->copied();
    };
    const auto make = [&] {
      std::vector<draw::Copy> copies;
      for (const auto& [offset, words] : calls.front()) copies.push_back({offset, words, 0});
      backend.copy(copies);
      calls.pop_front();
    };
    take();
    make();
    ASSERT_TRUE(planner->add(*pack.streamed));
    take();
    int pictures = 0, coarser = 0;
    for (int frame = 0, at_rest = 0; at_rest < 20; ++frame) {
      ASSERT_LT(frame, 400);
      (void)pack.streamed->pump();
      const auto sent = planner->upload(12000);
      ASSERT_TRUE(sent);
      take();
      while (calls.size() > late) make();
      at_rest += sent->pending == 0;
      const auto data = planner->draw(view, instance);
      ASSERT_TRUE(data);
      const std::vector<Seen> seen = backend.seen(*data, false, kPicture);
      for (const Seen& one : seen) {
        pictures += one.instance == 0;
        coarser += one.instance == 0 && one.level > 0;
        ASSERT_TRUE(one.instance < 0 || isSolid(*pack.whole, one));
      }
      if (at_rest < 20) continue;
      if (truth.empty()) truth = seen;
      EXPECT_TRUE(seen == truth);
    }
    EXPECT_GT(coarser, 100);
    EXPECT_GT(pictures, coarser);
    EXPECT_EQ(backend.readsOutside(), 0u);
  }
}

// A pool that holds nothing, or anything: every draw ends.
TEST(LateUpload, WithoutCopiesEveryDrawEnds) {
  std::vector<std::unique_ptr<StreamedPack>> packs = crowd();
  const std::vector<Instance> instances = instancesOf(packs);
  for (const draw::Features features : {draw::Features::kNone, draw::Features::kDistances}) {
    const auto planner = draw::Planner::create({.pool_bytes = kTinyPool, .features = features}).value();
    planner->copied();
    for (const auto& pack : packs) {
      EXPECT_TRUE(pack->streamed->loadAll());
      ASSERT_TRUE(planner->add(*pack->streamed));
      planner->copied();
    }
    (void)planner->upload(~std::uint64_t{0});
    draw::View view = lookFrom({2.5f, 0.8f, 3}, {2.5f, 0.5f, 0});
    view.camera.viewport = {12, 9};
    if (features == draw::Features::kDistances) view.quality.soft_shadows = 2, view.quality.occlusion = true;
    std::mt19937 random(3);
    for (int filling = 0; filling < 4; ++filling) {
      CpuBackend backend(kTinyPool, features);
      std::vector<std::uint32_t> words(kTinyPool / 4);
      for (std::uint32_t& word : words) {
        const auto number = static_cast<std::uint32_t>(random());
        word = filling == 0   ? 0
               : filling == 1 ? ~0u
               : filling == 2 ? number
                              : number % static_cast<std::uint32_t>(words.size());
      }
      const draw::Copy all{0, words, 0};
      backend.copy({&all, 1});
      for (const draw::Pass pass : {draw::Pass::kColor, draw::Pass::kFog}) {
        Picture picture(view.camera.viewport);
        const auto data = planner->draw(view, instances, pass);
        ASSERT_TRUE(data);
        ASSERT_FALSE(data->calls.empty());
        backend.draw(*data, pass, false, picture);
        if (filling > 0) continue;
        for (const glm::vec4& color : picture.colors) EXPECT_EQ(color, glm::vec4(0));
      }
    }
  }
}

}  // namespace
}  // namespace kelp::test

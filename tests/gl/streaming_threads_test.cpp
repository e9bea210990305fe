// SPDX-License-Identifier: MIT
// Everything at once: threads that pump, threads that ask rays, one that tries again, and the one that draws.
// For the thread sanitizer.
#include <chrono>
#include <cstdlib>
#include <thread>

#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "streamed.h"
#include "support/voxel_points.h"

namespace kelp::test {
namespace {

using runtime::Instance;

class StreamingThreadsTest : public GlTest {
 protected:
  // In that part of the memory it takes.
  void run(int part, std::uint64_t gpu_budget) {
    HostSource source(bytesOf(packOf(dust({96, 128, 96}, 40, 4))));
    const auto whole = openAsset(source);
    ASSERT_TRUE(whole->loadAll());
    const std::uint64_t memory_budget = whole->memory() / static_cast<std::uint64_t>(part);
    runtime::AssetOptions options;
    options.memory_budget = memory_budget;
    // Large blocks that were let go while the asset lived: pages that made room, and a few buffers that grew.
    std::atomic<long> dropped{0};
    options.allocator = {[](void*, std::size_t size) { return std::malloc(size); },
                         [](void* user, void* memory, std::size_t size) {
                           if (memory && size > 20'000) ++*static_cast<std::atomic<long>*>(user);
                           std::free(memory);
                         },
                         &dropped};
    const auto asset = openAsset(source, options);
    // Now and then a read fails.
    std::atomic<int> reads{0};
    std::atomic<bool> flaky{true}, resting{false}, stop{false};
    std::atomic<int> frames_drawn{0};
    source.answers = [&](std::uint64_t, std::size_t) {
      return !flaky || ++reads % 7 != 0 ? Read::kDone : Read::kFailed;
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i) {
      threads.emplace_back([&] {
        while (!stop) {
          const auto more = asset->pump();
          if (more && !*more) std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
      });
    }
    std::atomic<long> hits{0};
    for (int i = 0; i < 2; ++i) {
      threads.emplace_back([&, i] {
        runtime::Pose pose = *runtime::Pose::create(*asset);
        const Instance instance{asset.get(), &pose};
        std::mt19937 random(static_cast<unsigned>(i));
        std::uniform_real_distribution<float> unit(0, 1);
        for (long n = 0; !resting; ++n) {
          if (n % 64 == 0) sway(pose, 0, 0.01f * static_cast<float>(n), 0.1f);
          // All look at one place for a while, then at another: what was there before may go.
          const auto place = static_cast<unsigned>(frames_drawn / 16);
          const float height = static_cast<float>(place * 37 % 128);
          const glm::vec3 target =
              voxelToWorld(instance, 0, {96 * unit(random), height + 8 * unit(random), 96 * unit(random)});
          const glm::vec3 eye = target + glm::vec3(unit(random), 0.02f * unit(random), 2);
          hits += raycast(instance, {eye, target - eye}, static_cast<int>(n % 3)).has_value();
          if (const auto* data = asset->level(0, 0)) {
            const auto page = runtime::PageAccess::pin(
                *asset, {0, 0}, place % static_cast<std::uint32_t>(data->pages.size()), unit(random));
            if (page) hits += page.words().back() == 1;  // reads it
          }
          (void)asset->residentLevel(0);
          (void)asset->memory();
        }
      });
    }
    threads.emplace_back([&] {
      while (!stop) {
        asset->retry();
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
      }
    });
    const DepthCanvas canvas(GetParam(), {24, 32}, GL_DEPTH_COMPONENT32F);
    gl::RendererOptions config;
    config.gpu_budget = gpu_budget;
    const auto renderer = createRenderer(config);
    ASSERT_TRUE(renderer->add(*asset));
    runtime::Pose pose = *runtime::Pose::create(*asset);
    const Instance instance{asset.get(), &pose};
    bool seen = false;
    for (int frame = 0; frame < 250; ++frame) {
      sway(pose, 0, static_cast<float>(frame) / 60.0f, 0.1f);
      const auto sent = renderer->upload(32 << 10);
      ++frames_drawn;
      EXPECT_TRUE(sent) << sent.error().detail;
      const auto drawn =
          renderer->draw(lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0}), {&instance, 1});
      EXPECT_TRUE(drawn) << drawn.error().detail;
      EXPECT_TRUE(!seen || drawn->instances == 1);
      seen = seen || drawn->instances == 1;
      EXPECT_LE(asset->memory(), memory_budget);
    }
    // Pages that rays use stay in memory, and may leave too little room for those that the renderer waits
    // for: so the rays rest now.
    resting = true;
    flaky = false;
    asset->retry();
    std::uint32_t pending = 1;
    for (int frame = 0; frame < 3000 && pending > 0; ++frame) {
      const auto sent = renderer->upload(256 << 10);
      ASSERT_TRUE(sent);
      pending = sent->pending;
      if (pending > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    stop = true;
    for (std::thread& thread : threads) thread.join();
    EXPECT_TRUE(seen);
    EXPECT_EQ(pending, 0u);
    EXPECT_GT(hits, 0);
    RecordProperty("dropped", static_cast<int>(dropped));
    if (part > 1) {
      EXPECT_GT(dropped, 25) << "hardly a page had to go";
    }
  }
};

TEST_P(StreamingThreadsTest, InMemoryEnough) { run(1, 16 << 20); }
TEST_P(StreamingThreadsTest, WhilePagesComeAndGo) { run(3, 16 << 20); }

KELP_GL_TESTS(StreamingThreadsTest);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Everything at once: threads that pump, threads that ask rays, one that tries again, and the one that draws. For the thread sanitizer.
#include <chrono>
#include <thread>

#include "streamed.h"

namespace kelp::test {
namespace {

using runtime::Instance;

class StreamingThreadsTest : public GlTest {
 protected:
  void run(std::uint64_t memory_budget, std::uint64_t gpu_budget) {
    HostSource source(bytesOf(packOf(reed(256, 2))));
    runtime::Options options;
    options.memory_budget = memory_budget;
    const auto asset = openAsset(source, options);
    // Now and then a read fails.
    std::atomic<int> reads{0};
    std::atomic<bool> flaky{true}, stop{false};
    source.allows = [&](std::uint64_t, std::size_t) { return !flaky || ++reads % 7 != 0; };
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
        for (long n = 0; !stop; ++n) {
          if (n % 64 == 0) sway(pose, 0, 0.01f * static_cast<float>(n), 0.1f);
          const glm::vec3 target = toWorld(instance, 0, {64 * unit(random), 256 * unit(random), 51 * unit(random)});
          hits += raycast(instance, {{0.3f, unit(random), 2}, target - glm::vec3(0.3f, 0.5f, 2)}, static_cast<int>(n % 3)).has_value();
          const int level = static_cast<int>(n % 2);
          if (const auto* data = asset->level(0, level)) {
            const auto page = asset->pin(0, level, static_cast<std::uint32_t>(random() % data->pages.size()), unit(random));
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
    gl::Config config;
    config.gpu_budget = gpu_budget;
    const auto renderer = createRenderer(config);
    ASSERT_TRUE(renderer->add(*asset));
    runtime::Pose pose = *runtime::Pose::create(*asset);
    const Instance instance{asset.get(), &pose};
    bool seen = false;
    for (int frame = 0; frame < 120; ++frame) {
      sway(pose, 0, static_cast<float>(frame) / 60.0f, 0.1f);
      const auto sent = renderer->upload(32 << 10);
      EXPECT_TRUE(sent) << sent.error().detail;
      const auto drawn = renderer->draw(lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0}), {&instance, 1});
      EXPECT_TRUE(drawn) << drawn.error().detail;
      EXPECT_TRUE(!seen || drawn->instances == 1);
      seen = seen || drawn->instances == 1;
      EXPECT_LE(asset->memory(), memory_budget);
    }
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
  }
};

TEST_P(StreamingThreadsTest, InMemoryEnough) { run(std::uint64_t{1} << 30, 16 << 20); }
TEST_P(StreamingThreadsTest, WhilePagesComeAndGo) { run(400 << 10, 512 << 10); }

KELP_GL_TESTS(StreamingThreadsTest);

}  // namespace
}  // namespace kelp::test

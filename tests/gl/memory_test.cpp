// SPDX-License-Identifier: MIT
// A frame allocates nothing once kelp has warmed up; memory or a context that is too small is an answer.
#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "count_new.h"
#include "support/edit_knots.h"
#include "support/fake_gl.h"

namespace kelp::test {
namespace {

using runtime::Instance;

struct Counter {
  long calls = 0;
  long left = -1;      // allocations that still succeed; -1: all
  bool and_on = true;  // after them none does; or one alone does not
  bool refused = false;
  long held = 0;
  Allocator allocator() {
    Allocator out;
    out.user = this;
    out.allocate = [](void* user, std::size_t bytes) -> void* {
      auto& self = *static_cast<Counter*>(user);
      ++self.calls;
      if (self.left == 0) {
        if (!self.and_on) self.left = -1;
        self.refused = true;
        return nullptr;
      }
      if (self.left > 0) --self.left;
      ++self.held;
      return std::malloc(bytes);
    };
    out.deallocate = [](void* user, void* memory, std::size_t) {
      --static_cast<Counter*>(user)->held;
      std::free(memory);
    };
    return out;
  }
};

// On a GL that does nothing: a driver allocates as it likes.
class MemoryTest : public testing::Test {
 protected:
  void SetUp() override { FakeGl::current() = &fake_; }
  gl::RendererOptions config() {
    gl::RendererOptions out;
    out.getProcAddress = FakeGl::getProcAddress;
    out.allocator = counter_.allocator();
    return out;
  }
  static gl::View view() {
    gl::View out;
    out.camera.eye_to_clip = glm::perspective(0.8f, 1.0f, 0.1f, 10.0f);
    out.camera.world_to_eye =
        glm::lookAt(glm::vec3(0.8f, 0.9f, 3.8f), glm::vec3(0, 0.5f, 0), glm::vec3(0, 1, 0));
    out.camera.viewport = {400, 400};
    return out;
  }

  FakeGl fake_;
  Counter counter_;
  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
};

TEST_F(MemoryTest, AFrameAllocatesNothingAfterWarmUp) {
  const auto created = gl::Renderer::create(config());
  ASSERT_TRUE(created);
  gl::Renderer& renderer = **created;
  ASSERT_TRUE(renderer.add(*loaded_.asset));
  ASSERT_TRUE(renderer.upload(~std::uint64_t{0}));
  runtime::Pose pose = *runtime::Pose::create(*loaded_.asset);
  std::vector<Instance> instances(50, Instance{loaded_.asset.get(), &pose});
  for (std::size_t i = 0; i < instances.size(); ++i)
    instances[i].to_world[3].x = 0.02f * static_cast<float>(i);
  gl::View lines = view();
  lines.debug = gl::DebugView::kSplines;
  ASSERT_TRUE(renderer.draw(lines, instances));
  ASSERT_TRUE(renderer.bindTrace(1, view(), instances));

  const long own = counter_.calls;
  const long all = newCalls();
  std::uint32_t draws = 0;
  for (int frame = 0; frame < 10; ++frame) {
    edit(pose, 0, 80)[1].tangent.x = static_cast<float>(frame);
    gl::View moved = view();
    moved.quality.pixels_per_voxel = static_cast<float>(frame % 4);  // other levels, other draws
    moved.debug = static_cast<gl::DebugView>(frame % 6);
    const auto some = std::span(instances).subspan(static_cast<std::size_t>(frame));
    const auto drawn = renderer.draw(moved, some);
    draws += drawn && renderer.draw(moved, some, gl::Pass::kDepth) && renderer.bindTrace(1, moved, some) &&
                     renderer.upload(1'000'000)
                 ? drawn->draws
                 : 0;
  }
  EXPECT_EQ(newCalls(), all);
  EXPECT_EQ(counter_.calls, own);
  EXPECT_GE(draws, 10u);
}

// Alone, and with all after it.
TEST_F(MemoryTest, EveryAllocationMayFail) {
  gl::View lines = view();
  lines.debug = gl::DebugView::kBounds;
  const Instance instance{loaded_.asset.get(), nullptr};
  for (const bool and_on : {false, true}) {
    counter_.and_on = and_on;
    int failures = 0;
    counter_.refused = true;
    for (long allowed = 0; counter_.refused; ++allowed) {
      ASSERT_LT(allowed, 100);
      counter_.left = allowed;
      counter_.refused = false;
      const auto check = [&](const auto& result) {
        if (result) return true;
        ++failures;
        EXPECT_TRUE(counter_.refused);
        EXPECT_EQ(result.error().code, ErrorCode::kOutOfMemory) << result.error().detail;
        return false;
      };
      const auto renderer = gl::Renderer::create(config());
      if (!check(renderer) || !check((*renderer)->add(*loaded_.asset))) continue;
      check((*renderer)->upload(~std::uint64_t{0}));
      check((*renderer)->draw(view(), {&instance, 1}));
      check((*renderer)->draw(lines, {&instance, 1}));
      check((*renderer)->bindTrace(1, view(), {&instance, 1}));
      if (and_on) continue;
      // Uploads that failed for want of memory are made by the next upload, at the latest.
      ASSERT_TRUE((*renderer)->upload(~std::uint64_t{0})) << allowed;
      const auto drawn = (*renderer)->draw(view(), {&instance, 1});
      ASSERT_TRUE(drawn) << allowed;
      EXPECT_EQ(drawn->instances, 1u) << allowed;
    }
    EXPECT_GT(failures, 4);
    EXPECT_EQ(counter_.held, 0);
  }
}

TEST_F(MemoryTest, TheGpusMemoryMayBeShort) {
  fake_.out_of_memory = true;
  const auto refused = gl::Renderer::create(config());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kOutOfMemory);
}

TEST_F(MemoryTest, BudgetsAreBounded) {
  gl::RendererOptions small = config();
  for (const std::uint64_t bytes : {std::uint64_t{0}, std::uint64_t{1}, (std::uint64_t{256} << 10) - 1}) {
    small.gpu_budget = bytes;
    const auto refused = gl::Renderer::create(small);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kMisuse);
  }
  small.gpu_budget = ~std::uint64_t{0};  // as much as one texture array holds
  const auto large = gl::Renderer::create(small);
  ASSERT_TRUE(large);
  ASSERT_TRUE((*large)->add(*loaded_.asset));
  EXPECT_EQ((*large)->upload(~std::uint64_t{0})->pending, 0u);
  // The coarsest levels of more and more assets: at some point there is no room for another.
  small.gpu_budget = std::uint64_t{256} << 10;
  const auto tiny = gl::Renderer::create(small);
  ASSERT_TRUE(tiny);
  std::vector<std::unique_ptr<LoadedAsset>> assets;
  bool full = false;
  for (int i = 0; i < 40 && !full; ++i) {
    assets.push_back(std::make_unique<LoadedAsset>(packOf(ballClump({20, 20, 20}, 3, 2))));
    const auto added = (*tiny)->add(*assets.back()->asset);
    const auto sent = (*tiny)->upload(~std::uint64_t{0});
    full = !added || !sent;
    EXPECT_TRUE(added || added.error().code == ErrorCode::kLimit);
    EXPECT_TRUE(sent || sent.error().code == ErrorCode::kLimit);
  }
  EXPECT_TRUE(full);
}

TEST_F(MemoryTest, OldContextsAreRefused) {
  for (const char* version : {"OpenGL ES 2.0 fake", "3.2 fake", "2.1", "", "nonsense"}) {
    fake_.version = version;
    const auto created = gl::Renderer::create(config());
    ASSERT_FALSE(created) << version;
    EXPECT_EQ(created.error().code, ErrorCode::kGraphics);
  }
  for (const char* version : {"OpenGL ES 3.0 fake", "OpenGL ES 3.2 fake", "3.3 fake", "4.6.0 fake 1.2.3"}) {
    fake_.version = version;
    EXPECT_TRUE(gl::Renderer::create(config())) << version;
  }
}

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// In C, too, a picture that is empty or wrong is explained.
#include <thread>

#include "../gl/canvas.h"
#include "both.h"

namespace kelp::test {
namespace {

class CSilence : public GlTest {};

TEST_P(CSilence, StatsContextsAndClampedPoses) {
  const Canvas canvas({40, 40});
  static std::string said;
  said.clear();
  auto config = sized<kelp_renderer_options>();
  ASSERT_KELP(kelp_renderer_options_defaults(&config));
  config.gpu_budget = 1 << 20;
  config.get_proc_address = EglContext::getProcAddress;
  config.log = [](void*, const char* text) { said += text; };
  kelp_renderer renderer = {};
  ASSERT_KELP(kelp_renderer_create(&config, &renderer));
  kelp_asset asset = {};
  ASSERT_KELP(kelp_asset_open_file(packFile("solid").c_str(), nullptr, &asset));
  ASSERT_KELP(kelp_renderer_add(renderer, asset));
  auto view = sized<kelp_view>();
  ASSERT_KELP(kelp_view_defaults(&view));
  const gl::View from = orthographic({40, 40}, {0, 0, 50}, {0, 0, 0}, 40, 1, 100);
  std::memcpy(view.world_to_eye, &from.camera.world_to_eye, sizeof view.world_to_eye);
  std::memcpy(view.eye_to_clip, &from.camera.eye_to_clip, sizeof view.eye_to_clip);
  view.viewport[0] = view.viewport[1] = 40;
  auto instance = sized<kelp_instance>();
  ASSERT_KELP(kelp_instance_defaults(&instance));
  instance.asset = asset;
  ASSERT_KELP(kelp_pose_create(asset, nullptr, &instance.pose));
  auto stats = sized<kelp_stats>();
  const auto draw = [&] {
    return kelp_renderer_draw(renderer, &view, &instance, 1, KELP_PASS_COLOR, &stats);
  };
  ASSERT_KELP(draw());
  EXPECT_GT(stats.waiting, 0u);
  EXPECT_GT(stats.pending, 0u);
  EXPECT_NE(said.find("solid.kelp: nothing in memory"), std::string::npos) << said;
  ASSERT_KELP(kelp_asset_load_all(asset));
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, &stats));
  ASSERT_KELP(draw());
  EXPECT_EQ(0u, stats.waiting);
  EXPECT_GT(stats.instances, 0u);

  const float down[3] = {0, -2, 0};
  ASSERT_KELP(kelp_pose_move(instance.pose, 0, 1, down));
  ASSERT_KELP(draw());
  EXPECT_EQ(1u, stats.left_out);
  instance.unsound = KELP_UNSOUND_CLAMP;
  ASSERT_KELP(draw());
  EXPECT_EQ(0u, stats.left_out);
  EXPECT_EQ(1u, stats.clamped);
  instance.unsound = 2;
  EXPECT_KELP(KELP_ERROR_MISUSE, draw());
  instance.unsound = KELP_UNSOUND_LEAVE_OUT;

  std::thread([&] {
    EXPECT_KELP(KELP_ERROR_WRONG_THREAD, draw());
    ASSERT_KELP(kelp_renderer_use_here(renderer));
    EXPECT_KELP(KELP_ERROR_MISUSE, draw());  // no context is current on this thread
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_renderer_destroy(renderer));
  }).join();
  ASSERT_KELP(kelp_renderer_use_here(renderer));
  {
    const EglContext other(GetParam());
    EXPECT_KELP(KELP_ERROR_MISUSE, draw());
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_renderer_destroy(renderer));
  }
  ASSERT_TRUE(context_->makeCurrent());
  EXPECT_KELP(KELP_OK, draw());
  // A destroyed renderer leaves none of its textures behind.
  const auto textures = [] {
    int count = 0;
    for (GLuint name = 1; name < 1024; ++name) count += glIsTexture(name);
    return count;
  };
  EXPECT_GT(textures(), 0);
  EXPECT_KELP(KELP_OK, kelp_renderer_destroy(renderer));
  EXPECT_EQ(textures(), 0);
  kelp_renderer abandoned = {};
  ASSERT_KELP(kelp_renderer_create(&config, &abandoned));
  {
    const EglContext other(GetParam());
    EXPECT_KELP(KELP_OK, kelp_renderer_abandon(abandoned));
    EXPECT_KELP(KELP_OK, kelp_renderer_destroy(abandoned));
  }
  ASSERT_TRUE(context_->makeCurrent());
  EXPECT_KELP(KELP_OK, kelp_pose_destroy(instance.pose));
  EXPECT_KELP(KELP_OK, kelp_asset_destroy(asset));
}

KELP_GL_TESTS(CSilence);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Which level is drawn, and what uploads put where.
#include "canvas.h"

namespace kelp::test {
namespace {

using runtime::Instance;

class LevelTest : public GlTest {
 protected:
  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const Instance instance_{loaded_.asset.get(), nullptr};
  const Part& part_ = loaded_.asset->pack().parts()[0];

  // The one level that the canvas shows after drawing; -1: nothing.
  int drawnLevel(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view) {
    canvas.clear();
    EXPECT_TRUE(renderer.draw(view, {&instance_, 1}));
    int level = -1;
    for (const Pixel& pixel : canvas.pixels()) {
      if (pixel[3] == 0) continue;
      if (level >= 0) {
        EXPECT_EQ(level, 255 - pixel[3]);
      }
      level = 255 - pixel[3];
    }
    return level;
  }
};

TEST_P(LevelTest, IsTheFinestWhoseVoxelsAreLargeEnough) {
  const Canvas canvas({200, 200});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  // Orthographic: the model is 1 high and 80 voxels, so a level-0 voxel has 200 / (2 * half height) / 80 pixels.
  const auto expected = [&](float half_height, float pixels_per_voxel) {
    float pixels = 200.0f / (2 * half_height) / 80.0f;
    int level = 0;
    for (; level + 1 < part_.levels && pixels < pixels_per_voxel; ++level) pixels *= 2;
    return level;
  };
  for (const float half_height : {0.3f, 0.7f, 1.3f, 2.9f, 5.3f, 11.0f, 40.0f}) {
    for (const float pixels_per_voxel : {0.0f, 0.5f, 1.0f, 3.0f}) {
      gl::View view = orthographic(canvas, {0, 0.5f, 5}, {0, 0.5f, 0}, half_height);
      view.pixels_per_voxel = pixels_per_voxel;
      EXPECT_EQ(drawnLevel(*renderer, canvas, view), expected(half_height, pixels_per_voxel)) << half_height << " " << pixels_per_voxel;
    }
  }
  // With the eye in the volume something is arbitrarily near.
  gl::View inside = lookAt(canvas, {0, 0.5f, 0.1f}, {0, 0.5f, -1});
  inside.pixels_per_voxel = 100;
  EXPECT_EQ(drawnLevel(*renderer, canvas, inside), 0);
}

TEST_P(LevelTest, EveryLevelAgreesWithTheCpu) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  for (int level = 0; level < part_.levels; ++level) {
    gl::View view = lookAt(canvas, {1.1f, 1.2f, 1.8f}, {0, 0.5f, 0});
    // A voxel has about 150 / 80 / 2 pixels here; doubling the demand takes one level more.
    view.pixels_per_voxel = level == 0 ? 0.0f : static_cast<float>(1 << level);
    const int drawn = drawnLevel(*renderer, canvas, view);
    ASSERT_GE(drawn, level);
    const std::vector<Pixel> pixels = canvas.pixels();
    int hits = 0;
    int different = 0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const auto hit = raycast(instance_, pixelRay(view, x, y), drawn);
        const Pixel& pixel = pixels[static_cast<std::size_t>(160 * y + x)];
        hits += hit.has_value();
        different += hit.has_value() != (pixel[3] != 0) || (hit && glm::ivec3(pixel[0], pixel[1], pixel[2]) != hit->voxel);
      }
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LE(different, hits / 200) << "level " << drawn;
  }
}

TEST_P(LevelTest, UploadsCoarseToFineWithinTheBytesAsked) {
  const Canvas canvas({160, 120});
  gl::Config config;
  config.getProcAddress = EglContext::getProcAddress;
  config.surface_glsl = kVoxelSurface;
  auto created = gl::Renderer::create(config);
  ASSERT_TRUE(created);
  gl::Renderer& renderer = **created;
  ASSERT_TRUE(renderer.add(*loaded_.asset));
  const gl::View view = lookAt(canvas, {1.1f, 1.2f, 1.8f}, {0, 0.5f, 0});

  EXPECT_EQ(drawnLevel(renderer, canvas, view), -1);
  std::uint64_t held = renderer.upload(0)->gpu_bytes;  // at least one level, however little is allowed
  for (int level = part_.levels - 1; level >= 0; --level) {
    EXPECT_EQ(drawnLevel(renderer, canvas, view), level);
    const auto stats = renderer.upload(1);
    ASSERT_TRUE(stats);
    EXPECT_EQ(stats->gpu_bytes, held + stats->bytes_uploaded);
    EXPECT_EQ(stats->pending, static_cast<std::uint32_t>(std::max(level - 1, 0)));
    held = stats->gpu_bytes;
  }
  EXPECT_EQ(renderer.upload(1)->bytes_uploaded, 0u);
  renderer.remove(*loaded_.asset);
  EXPECT_EQ(renderer.upload(1)->gpu_bytes, 0u);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_P(LevelTest, StaysWithinTheBudget) {
  const Canvas canvas({160, 120});
  gl::Config config;
  config.getProcAddress = EglContext::getProcAddress;
  config.surface_glsl = kVoxelSurface;
  config.gpu_budget = 200'000;
  auto created = gl::Renderer::create(config);
  ASSERT_TRUE(created);
  gl::Renderer& renderer = **created;
  ASSERT_TRUE(renderer.add(*loaded_.asset));
  const auto uploaded = renderer.upload(~std::uint64_t{0});
  ASSERT_FALSE(uploaded);
  EXPECT_EQ(uploaded.error().code, ErrorCode::kLimit);
  // What fits is there and is drawn.
  const gl::View view = lookAt(canvas, {1.1f, 1.2f, 1.8f}, {0, 0.5f, 0});
  const int level = drawnLevel(renderer, canvas, view);
  EXPECT_GT(level, 0);
  EXPECT_LT(level, part_.levels);
  const auto stats = renderer.draw(view, {&instance_, 1});
  ASSERT_TRUE(stats);
  EXPECT_LE(stats->gpu_bytes, config.gpu_budget);
  EXPECT_GT(stats->pending, 0u);
}

TEST_P(LevelTest, InstancesOutOfSightAreCulled) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset);
  Instance instances[3] = {instance_, instance_, instance_};
  instances[1].to_world[3] = glm::vec4(50, 0, 0, 1);    // beside
  instances[2].to_world[3] = glm::vec4(0, 0, 5, 1);     // behind the eye
  const auto stats = renderer->draw(lookAt(canvas, {0, 0.5f, 3}, {0, 0.5f, 0}), instances);
  ASSERT_TRUE(stats);
  EXPECT_EQ(stats->instances, 1u);
  EXPECT_EQ(stats->culled, 2u);
  EXPECT_EQ(stats->draws, 1u);
}

KELP_GL_TESTS(LevelTest);

}  // namespace
}  // namespace kelp::test

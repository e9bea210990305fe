// SPDX-License-Identifier: MIT
// Too little memory, on the GPU and beside it: for hundreds of frames nothing fails, everything is drawn, and
// a camera at rest brings rest.
#include <algorithm>
#include <cmath>

#include "streamed.h"
#include "support/cage_pack.h"
#include "support/fake_gl.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// Some reeds of several kinds in rows, in the wind.
struct Meadow {
  Meadow(int kinds, int count, int height, const runtime::AssetOptions& options = {}) {
    for (int kind = 0; kind < kinds; ++kind) {
      sources.push_back(std::make_unique<HostSource>(
          bytesOf(packOf(reed(height + 16 * kind, static_cast<unsigned>(kind + 1))))));
      assets.push_back(openAsset(*sources.back(), options));
    }
    poses.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      const runtime::Asset& asset = *assets[static_cast<std::size_t>(i % kinds)];
      poses.push_back(*runtime::Pose::create(asset));
      instances.push_back({&asset, &poses.back()});
      instances.back().to_world[3] =
          glm::vec4(0.4f * static_cast<float>(i % 5 - 2), 0, -0.35f * static_cast<float>(i / 5), 1);
    }
  }
  void blow(float seconds, float reach = 0.15f) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      sway(poses[i], 0, seconds + 1.7f * static_cast<float>(i), reach);
  }
  void pump(int pages) {
    for (const auto& asset : assets) {
      for (int i = 0; i < pages; ++i) {
        const auto more = asset->pump();
        ASSERT_TRUE(more) << more.error().detail;
        if (!*more) break;
      }
    }
  }
  // Of poolBytes, once everything was loaded elsewhere.
  std::uint64_t gpuBytes() const {
    std::uint64_t all = 0;
    for (const auto& source : sources) {
      const auto asset = openAsset(*source);
      EXPECT_TRUE(asset->loadAll());
      all += gl::poolBytes(*asset);
    }
    return all;
  }

  std::vector<std::unique_ptr<HostSource>> sources;
  std::vector<std::unique_ptr<runtime::Asset>> assets;
  std::vector<runtime::Pose> poses;
  std::vector<Instance> instances;
};

gl::View flight(const glm::ivec2& viewport, float along) {
  gl::View view =
      lookAt(viewport, {0.9f * std::sin(0.8f * along), 0.6f + 0.2f * std::sin(along), 1.0f - along},
             {0.3f * std::cos(along), 0.45f, -1.5f - along}, 0.05f, 50.0f);
  view.quality.pixels_per_voxel = 0.25f;  // a small picture that asks for as much as a large one
  return view;
}

// Frames with the camera at rest and the wind blowing. Which was the last that had anything to upload; -1:
// none.
int framesToRest(gl::Renderer& renderer, Meadow& meadow, const gl::View& view, int frames, float reach,
                 std::uint64_t budget) {
  int last_moving = -1;
  for (int frame = 0; frame < frames; ++frame) {
    meadow.blow(40.0f + static_cast<float>(frame) / 60.0f, reach);
    meadow.pump(8);
    const auto sent = renderer.upload(128 << 10);
    EXPECT_TRUE(sent) << sent.error().detail;
    EXPECT_LE(sent->gpu_bytes, budget);
    if (sent->bytes_uploaded > 0 || sent->pending > 0) last_moving = frame;
    const auto drawn = renderer.draw(view, meadow.instances);
    EXPECT_TRUE(drawn) << drawn.error().detail;
    EXPECT_EQ(drawn->instances + drawn->culled, meadow.instances.size());
  }
  return last_moving;
}

class BudgetTest : public GlTest {};

TEST_P(BudgetTest, AQuarterOfTheScenesBytesDrawsAllTheTime) {
  Meadow meadow(5, 30, 320);
  const std::uint64_t budget = meadow.gpuBytes() / 4;
  const DepthCanvas canvas(GetParam(), {32, 24}, GL_DEPTH_COMPONENT32F);
  gl::RendererOptions config;
  config.getProcAddress = CountedGl::getProcAddress;
  config.gpu_budget = budget;
  const auto renderer = createRenderer(config);
  for (const auto& asset : meadow.assets) ASSERT_TRUE(renderer->add(*asset));
  std::uint64_t moved = 0;
  for (int frame = 0; frame < 240; ++frame) {
    meadow.blow(static_cast<float>(frame) / 60.0f);
    meadow.pump(2);
    const std::uint64_t before = CountedGl::bytes();
    const auto sent = renderer->upload(32 << 10);
    ASSERT_TRUE(sent) << sent.error().detail;
    EXPECT_EQ(CountedGl::bytes() - before, sent->bytes_uploaded);
    EXPECT_LE(sent->bytes_uploaded, 32u << 10);
    EXPECT_LE(sent->gpu_bytes, budget);
    moved += sent->bytes_uploaded;
    if (frame % 2 == 0) continue;
    const gl::View view = flight(canvas.size(), 0.0075f * static_cast<float>(frame));
    canvas.clear();
    const auto drawn = renderer->draw(view, meadow.instances);
    ASSERT_TRUE(drawn) << drawn.error().detail;
    ASSERT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    if (frame < 20) continue;
    EXPECT_EQ(drawn->instances + drawn->culled, meadow.instances.size())
        << "something is not even drawn coarse";
    if (frame % 40 != 1) continue;
    // Where the finest level is seen on the CPU, there is no hole.
    const std::vector<float> depths = canvas.depths();
    for (int i = 0; i < 32 * 24; ++i) {
      for (const Instance& instance : meadow.instances) {
        if (raycast(instance, pixelRay(view, i % 32, i / 32))) {
          EXPECT_LT(depths[static_cast<std::size_t>(i)], 1.0f) << frame << " " << i;
          break;
        }
      }
    }
  }
  EXPECT_GT(moved, budget);
}

// Cages lie beside their levels. Where other models take the room, they go, and they come again.
TEST_P(BudgetTest, CagesComeAndGoWithTheirLevels) {
  const Canvas canvas({64, 48});
  const gl::View view = lookAt(canvas, {0.7f, 0.6f, 0.9f}, {0, 0.5f, 0});
  std::vector<std::unique_ptr<LoadedAsset>> models;
  std::vector<runtime::Pose> poses;
  for (const unsigned seed : {1u, 2u, 3u}) {
    models.push_back(std::make_unique<LoadedAsset>(cagedPackOf(reed(192, seed), 2)));
    poses.push_back(*runtime::Pose::create(*models.back()->asset));
    sway(poses.back(), 0, 1.3f, 0.15f);
  }
  const auto rendererOf = [&](std::uint64_t budget) {
    gl::RendererOptions config;
    config.gpu_budget = budget;
    auto renderer = createRenderer(config);
    for (const auto& model : models) EXPECT_TRUE(renderer->add(*model->asset));
    return renderer;
  };
  struct Visit {
    std::uint64_t uploaded = 0, held = 0;
    std::vector<Pixel> picture;
  };
  // Draws a model until nothing is pending.
  const auto visit = [&](gl::Renderer& renderer, std::size_t model) {
    Visit made;
    for (int frame = 0; frame < 200; ++frame) {
      const auto sent = renderer.upload(1 << 20);
      EXPECT_TRUE(sent) << sent.error().detail;
      made.uploaded += sent->bytes_uploaded;
      made.held = sent->gpu_bytes;
      canvas.clear();
      const auto drawn = renderer.draw(view, Instance{models[model]->asset.get(), &poses[model]});
      EXPECT_TRUE(drawn) << drawn.error().detail;
      made.picture = canvas.pixels();
      if (frame > 20 && sent->pending == 0 && sent->bytes_uploaded == 0) return made;
    }
    ADD_FAILURE() << "something stays pending";
    return made;
  };
  const auto whole = rendererOf(kGpuBudget);
  std::vector<Visit> free;
  for (std::size_t model = 0; model < models.size(); ++model) free.push_back(visit(*whole, model));
  EXPECT_TRUE(free[0].picture != free[1].picture);
  const std::uint64_t one = free[2].held / 3, budget = one / 4 * 7;
  const auto renderer = rendererOf(budget);
  std::uint64_t uploaded = 0;
  for (const std::size_t model : {0u, 1u, 2u, 0u}) {
    const Visit made = visit(*renderer, model);
    EXPECT_LE(made.held, budget);
    EXPECT_TRUE(made.picture == free[model].picture) << "model " << model;
    uploaded = made.uploaded;
  }
  // So much that the finest cage was among it.
  const std::uint64_t cage = models[0]->asset->pack().parts()[0].cages[0].words.size_bytes();
  EXPECT_GT(uploaded + cage, one);
}

KELP_GL_TESTS(BudgetTest);

// Residency does not depend on pictures, so these tests use an OpenGL that draws nothing: it is fast.
class Residents : public testing::Test {
 protected:
  void SetUp() override { FakeGl::current() = &fake_; }
  static std::unique_ptr<gl::Renderer> create(std::uint64_t budget) {
    gl::RendererOptions config;
    config.getProcAddress = FakeGl::getProcAddress;
    config.gpu_budget = budget;
    return createRenderer(config);
  }
  FakeGl fake_;
};

TEST_F(Residents, SettleWhenTheCameraRestsHoweverTheWindBlows) {
  Meadow meadow(5, 30, 320);
  const std::uint64_t budget = meadow.gpuBytes() / 4;
  const auto renderer = create(budget);
  for (const auto& asset : meadow.assets) ASSERT_TRUE(renderer->add(*asset));
  for (int frame = 0; frame < 300; ++frame) {
    meadow.blow(static_cast<float>(frame) / 60.0f);
    meadow.pump(2);
    ASSERT_TRUE(renderer->upload(32 << 10));
    ASSERT_TRUE(renderer->draw(flight({48, 36}, 0.006f * static_cast<float>(frame)), meadow.instances));
  }
  for (const float reach : {0.0f, 0.1f, 0.3f, 0.5f}) {
    const int last = framesToRest(*renderer, meadow, flight({48, 36}, 1.8f), 1500, reach, budget);
    EXPECT_LT(last, 1000) << "wind " << reach;
  }
  // Another place, and back.
  (void)framesToRest(*renderer, meadow, flight({48, 36}, 0.2f), 100, 0.2f, budget);
  const int back = framesToRest(*renderer, meadow, flight({48, 36}, 1.8f), 2500, 0.2f, budget);
  EXPECT_LT(back, 1000);
}

TEST_F(Residents, AreCoarseWhereAVolumeIsLargerThanTheBudget) {
  Meadow meadow(1, 3, 384);
  const std::uint64_t budget = 256 << 10;
  ASSERT_GT(meadow.gpuBytes(), 3 * budget);
  const auto renderer = create(budget);
  ASSERT_TRUE(renderer->add(*meadow.assets[0]));
  EXPECT_LT(framesToRest(*renderer, meadow, flight({400, 300}, 0.0f), 500, 0.1f, budget), 300);
  const auto drawn = renderer->draw(flight({400, 300}, 0.0f), meadow.instances);
  ASSERT_TRUE(drawn);
  EXPECT_GE(drawn->instances, 1u);
  EXPECT_GT(drawn->gpu_bytes, budget / 2) << "the budget is there to be used";
}

// Thousands of parts, in a budget that holds the coarsest levels of some only: an answer, and what fits is
// drawn.
TEST_F(Residents, OfThousandsOfParts) {
  RawPack pack;
  pack.info_json = "{}";
  pack.palette = {Material{}};
  const fields::Occupancy volume = ballClump({12, 16, 12}, 4, 1);
  for (int i = 0; i < 3000; ++i)
    pack.parts.push_back(partOf(volume, figureKnots(kFigure6[0]), "part " + std::to_string(i)));
  HostSource source(bytesOf(pack));
  const auto asset = openAsset(source);
  ASSERT_TRUE(asset->loadAll());
  const Instance instance{asset.get()};
  for (const std::uint64_t budget :
       {std::uint64_t{256} << 10, std::uint64_t{4} << 20, std::uint64_t{128} << 20}) {
    const auto renderer = create(budget);
    ASSERT_TRUE(renderer->add(*asset));
    const bool all = budget > gl::poolBytes(*asset);
    bool settled = false;
    for (int frame = 0; frame < 40; ++frame) {
      const auto sent = renderer->upload(4 << 20);
      if (!sent) {
        EXPECT_EQ(sent.error().code, ErrorCode::kLimit);
      }
      EXPECT_TRUE(sent || !all);
      const auto drawn = renderer->draw(flight({400, 300}, 0.0f), {&instance, 1});
      ASSERT_TRUE(drawn);
      EXPECT_LE(drawn->gpu_bytes, budget);
      EXPECT_GT(drawn->instances, 0u);
      settled = sent && sent->bytes_uploaded == 0 && sent->pending == 0;
    }
    EXPECT_EQ(settled, all);
  }
}

// The memory of the assets is short too: pages go and come, all that is asked for in turn.
TEST_F(Residents, SettleInAQuarterOfTheMemoryToo) {
  std::uint64_t all = 0;
  {
    Meadow meadow(1, 1, 320);
    ASSERT_TRUE(meadow.assets[0]->loadAll());
    all = meadow.assets[0]->memory();
  }
  runtime::AssetOptions options;
  options.memory_budget = all / 4;
  Meadow meadow(3, 12, 320, options);
  for (const std::uint64_t budget : {meadow.gpuBytes() / 4, 2 * meadow.gpuBytes()}) {
    const auto renderer = create(budget);
    for (const auto& asset : meadow.assets) ASSERT_TRUE(renderer->add(*asset));
    const gl::View view = flight({400, 300}, 0.0f);
    const int last = framesToRest(*renderer, meadow, view, 2500, 0.2f, ~std::uint64_t{0});
    EXPECT_LT(last, 1200) << budget;
    for (const auto& asset : meadow.assets) EXPECT_LE(asset->memory(), options.memory_budget);
    const auto drawn = renderer->draw(view, meadow.instances);
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->pending, 0u);
    if (budget > meadow.gpuBytes()) {
      EXPECT_GT(drawn->gpu_bytes, meadow.gpuBytes() / 2)
          << "the GPU's budget holds it all, page by page through too little memory";
    }
  }
}

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Parts with cages in a scene: two levels in a picture, streaming, other parts beside them, bad nodes.
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "caged.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using CagedScene = CagedTest;

// Two levels in a pattern of pixels, through the cage of the finer one.
constexpr char kLevelSurface[] =
    "vec4 kelpSurface(KelpSurface s) { return vec4(float(s.level) / 10.0, s.rest.xy / s.size.xy, 1.0); }\n";

class TwoLevels : public CagedTest {
 protected:
  // Between levels 1 and 2.
  gl::View between(const Canvas& canvas, const Instance& instance) const {
    gl::View view = closeTo(canvas, instance);
    view.quality.pixels_per_voxel = 0.1f;
    for (float& wanted = view.quality.pixels_per_voxel; wanted < 100; wanted *= 1.05f) {
      int counts[3] = {};
      for (int i = 0; i < 64; ++i) {
        const auto level = gl::levelAt(view, instance, 0, {i % 8, i / 8});
        if (level && *level < 3) ++counts[*level];
      }
      if (counts[1] > 20 && counts[2] > 20) return view;
    }
    ADD_FAILURE() << "no such view";
    return view;
  }
  static int levelOf(const Pixel& pixel) { return static_cast<int>(std::lround(pixel[0] / 25.5)); }

  const fields::Occupancy volume_ = ballClump({120, 160, 100}, 20, 2);
};

TEST_P(TwoLevels, EachDrawsItsOwnPixels) {
  const Canvas canvas({160, 120});
  const LoadedAsset plain(packOf(volume_)), with(cagedPackOf(volume_, 8));
  ASSERT_GT(with.asset->pack().parts()[0].cages.size(), 1u);
  const auto plain_renderer = makeRenderer(*plain.asset, kLevelSurface),
             renderer = makeRenderer(*with.asset, kLevelSurface);
  const gl::View view = between(canvas, {with.asset.get()});
  const std::vector<Pixel> expected = draw(*plain_renderer, view, {plain.asset.get()}, canvas),
                           seen = draw(*renderer, view, {with.asset.get()}, canvas);
  const Difference difference = differenceOf(expected, seen, canvas.size());
  EXPECT_LE(difference.outline, difference.covered / 50);
  EXPECT_LE(difference.apart, difference.covered / 100);
  int other = 0, counts[10] = {};
  for (int i = 0; i < 160 * 120; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (expected[at][3] == 0 || seen[at][3] == 0) continue;
    ++counts[levelOf(seen[at])];
    other += levelOf(seen[at]) != levelOf(expected[at]);
  }
  EXPECT_LE(other, difference.covered / 8);  // their bounds differ a little
  EXPECT_GT(counts[1], 1000);
  EXPECT_GT(counts[2], 1000);
}

// The finer one comes when all bricks of the next coarser one are there; the part is always drawn.
TEST_P(TwoLevels, ComeOneAfterTheOther) {
  const Canvas canvas({160, 120});
  const std::vector<std::byte> bytes = bytesOf(cagedPackOf(volume_, 8));
  MemorySource source(bytes);
  const auto asset = runtime::Asset::open(source.source()).value(),
             whole = runtime::Asset::open(source.source()).value();
  ASSERT_TRUE(whole->loadAll());
  const auto all = makeRenderer(*whole, kLevelSurface);
  gl::View view = between(canvas, {whole.get()});
  const std::vector<Pixel> truth = draw(*all, view, {whole.get()}, canvas);
  gl::RendererOptions options;
  options.getProcAddress = EglContext::getProcAddress;
  options.surface_glsl = kLevelSurface;
  options.gpu_budget = kGpuBudget;
  const auto renderer = gl::Renderer::create(options).value();
  ASSERT_TRUE(renderer->add(*asset));
  const Instance instance{asset.get()};
  std::vector<Pixel> seen;
  int finer = 0, coarser = 0, frames = 0;
  for (bool more = true; more; ++frames) {
    ASSERT_LT(frames, 3000);
    const bool loaded = asset->pump().value();
    const auto sent = renderer->upload(8192);
    ASSERT_TRUE(sent);
    more = loaded || sent->pending > 0;
    canvas.clear();
    const auto drawn = renderer->draw(view, instance);
    ASSERT_TRUE(drawn);
    if (drawn->instances == 0) continue;
    seen = canvas.pixels();
    int levels[10] = {};
    for (const Pixel& pixel : seen)
      if (pixel[3] != 0) ++levels[levelOf(pixel)];
    finer += levels[1] > 100;
    coarser += levels[1] == 0;
    EXPECT_GT(differenceOf(truth, seen, canvas.size()).iou(), finer == 0 ? 0.3 : 0.9);
  }
  EXPECT_GT(coarser, 3);
  EXPECT_GT(finer, 0);
  EXPECT_EQ(seen, truth);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_P(CagedScene, InstancesOfAllKindsShareAPicture) {
  const Canvas canvas({160, 120});
  const fields::Occupancy volume = ballClump({36, 96, 32}, 40, 3);
  const RawPack packs[] = {packOf(volume), sweptPackOf(volume, 5), caged(sweptPackOf(volume, 5), 2),
                           cagedPackOf(ballClump({16, 30, 20}, 9, 4), 8)};
  std::vector<std::unique_ptr<LoadedAsset>> assets;
  std::vector<Instance> instances;
  for (const RawPack& pack : packs) assets.push_back(std::make_unique<LoadedAsset>(pack));
  for (int i = 0; i < 12; ++i) {
    instances.push_back({assets[static_cast<std::size_t>(i % 4)]->asset.get()});
    instances.back().to_world[3] =
        glm::vec4(0.6f * static_cast<float>(i % 5) - 1, 0, -0.5f * static_cast<float>(i / 5), 1);
  }
  for (const gl::Features features : {gl::Features::kNone, gl::Features::kDistances}) {
    gl::RendererOptions config;
    config.features = features;
    const auto renderer = makeRenderer(*assets[0]->asset, nullptr, config);
    for (std::size_t i = 1; i < 4; ++i) {
      ASSERT_TRUE(renderer->add(*assets[i]->asset));
    }
    while (renderer->upload(~std::uint64_t{0}).value().pending > 0) {
    }
    gl::View view = lookAt(canvas, {0.2f, 0.8f, 3}, {0, 0.5f, 0});
    canvas.clear();
    const auto drawn = renderer->draw(view, instances);
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->instances, 12u);
    EXPECT_GE(drawn->draws, features == gl::Features::kNone ? 4u : 1u);
    const std::vector<Pixel> at_once = canvas.pixels();
    view.quality.depth_batches = 5;
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, instances));
    const Difference difference = differenceOf(at_once, canvas.pixels(), canvas.size());
    EXPECT_LE(difference.outline + difference.apart, 2);
    // One at a time.
    view.quality.depth_batches = 1;
    canvas.clear();
    for (const Instance& instance : instances) ASSERT_TRUE(renderer->draw(view, instance));
    EXPECT_EQ(canvas.pixels(), at_once);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  }
}

TEST_P(CagedScene, AnInstanceWithNodesThatAreNoNumbersIsLeftOut) {
  const Canvas canvas({60, 60});
  const LoadedAsset with(cagedPackOf(ballClump({60, 80, 50}, 20, 2), 8));
  gl::RendererOptions config;
  std::string said;
  config.log = [](void* user, const char* text) { *static_cast<std::string*>(user) += text; };
  config.user = &said;
  const auto renderer = makeRenderer(*with.asset, nullptr, config);
  runtime::Pose pose = *runtime::Pose::create(*with.asset);
  const Instance instances[] = {{with.asset.get()}, {with.asset.get(), &pose}};
  const gl::View view = closeTo(canvas, instances[0]);
  const std::vector<Pixel> one = draw(*renderer, view, instances[0], canvas);
  pose.nodes(0)[7].y = std::nanf("");
  canvas.clear();
  const auto drawn = renderer->draw(view, instances);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->left_out, 1u);
  EXPECT_EQ(drawn->first_left_out.offset, 1u);
  EXPECT_EQ(drawn->instances, 1u);
  EXPECT_EQ(canvas.pixels(), one);
  EXPECT_NE(said.find("instance 1"), std::string::npos) << said;
}

// Whatever the host does to nodes, a draw ends, without an error.
TEST_P(CagedScene, AnyNodesAreDrawn) {
  const Canvas canvas({60, 60});
  const LoadedAsset with(cagedPackOf(ballClump({60, 80, 50}, 20, 2), 8));
  const auto renderer = makeRenderer(*with.asset);
  runtime::Pose pose = *runtime::Pose::create(*with.asset);
  const std::vector<glm::vec3> rest(pose.nodes(0).begin(), pose.nodes(0).end());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int kind = 0; kind < 6; ++kind) {
    const std::span<glm::vec3> nodes = pose.nodes(0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const glm::vec3 anything(unit(random), unit(random), unit(random));
      nodes[i] = kind == 0   ? glm::vec3(3)
                 : kind == 1 ? glm::vec3(rest[i].x, 0, 0)
                 : kind == 2 ? glm::vec3(60 - rest[i].x, rest[i].y, rest[i].z)
                 : kind == 3 ? rest[i] + 8.0f * anything
                 : kind == 4 ? 1e7f * anything
                             : rest[i] + 4.0f * anything;
    }
    const Instance instance{with.asset.get(), &pose};
    const gl::View view = closeTo(canvas, {with.asset.get()});
    canvas.clear();
    EXPECT_TRUE(renderer->draw(view, instance)) << kind;
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  }
}

TEST_P(CagedScene, DebugViewsShowItAndItsCells) {
  const Canvas canvas({120, 90});
  const LoadedAsset with(cagedPackOf(ballClump({60, 80, 50}, 20, 2), 8));
  const auto renderer = makeRenderer(*with.asset);
  const Instance instance{with.asset.get()};
  gl::View view = closeTo(canvas, instance);
  const std::vector<Pixel> shaded = draw(*renderer, view, instance, canvas);
  view.debug = gl::DebugView::kParts;
  EXPECT_GT(differenceOf(shaded, draw(*renderer, view, instance, canvas), canvas.size()).iou(), 0.99);
  view.debug = gl::DebugView::kCages;
  const std::vector<Pixel> lines = draw(*renderer, view, instance, canvas);
  int changed = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) changed += lines[i] != shaded[i];
  EXPECT_GT(changed, 1000);
}

KELP_GL_TESTS(CagedScene);
KELP_GL_TESTS(TwoLevels);

}  // namespace
}  // namespace kelp::test

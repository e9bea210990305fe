// SPDX-License-Identifier: MIT
// A pick hits the voxel that is seen: raycast() against the depth buffer, over scenes of posed instances that
// stand in each other.
#include <cmath>
#include <set>

#include "streamed.h"

namespace kelp::test {
namespace {

using runtime::Hit;
using runtime::Instance;

class PicksTest : public GlTest {
 protected:
  // Random pixels, the picture's depth against the nearest hit of all instances.
  // Answers how many levels were met.
  int compare(const gl::View& view, std::span<const Instance> instances, const DepthCanvas& canvas,
              int pixels, const char* what) {
    const std::vector<float> depths = canvas.depths();
    std::mt19937 random(9);
    int hits = 0, off = 0;
    std::set<int> levels;
    double sum = 0;
    for (int n = 0; n < pixels; ++n) {
      const glm::ivec2 at(random() % static_cast<unsigned>(canvas.size().x),
                          random() % static_cast<unsigned>(canvas.size().y));
      runtime::Ray ray = pixelRay(view, at.x, at.y);
      std::optional<Hit> nearest;
      double voxel = 0;
      for (const Instance& instance : instances) {
        const int level = gl::levelAt(view, instance, 0, at).value();
        const auto hit = raycast(instance, ray, level);
        if (!hit) continue;
        nearest = hit;
        ray.t_max = hit->t;
        voxel = std::ldexp(double{glm::length(glm::vec3(runtime::partToWorld(instance, 0).value()[0]))},
                           hit->level);
      }
      const float depth = depths[static_cast<std::size_t>(at.x + canvas.size().x * at.y)];
      hits += nearest.has_value();
      levels.insert(nearest ? nearest->level : -1);
      if (nearest.has_value() != (depth < 1.0f)) {
        ++off;
        continue;
      }
      if (!nearest) continue;
      const double error =
          glm::length(unproject(view, at.x, at.y, depth) - glm::dvec3(nearest->position)) / voxel;
      off += error > 0.5;
      sum += std::min(error, 1.0);
    }
    EXPECT_GT(hits, pixels / 3) << what;
    // Rays that run along an edge: the GPU and the CPU round differently.
    EXPECT_LE(off, pixels / 500) << what;
    EXPECT_LT(sum / hits, 0.02) << what;
    RecordProperty(std::string(what) + "_off", off);
    return static_cast<int>(levels.size()) - 1;
  }
};

TEST_P(PicksTest, AreWhatIsSeen) {
  std::vector<std::unique_ptr<HostSource>> sources;
  std::vector<std::unique_ptr<runtime::Asset>> assets;
  gl::RendererOptions config;
  config.gpu_budget = 64 << 20;
  const auto renderer = createRenderer(config);
  const RawPack packs[] = {packOf(reed(160, 1)), packOf(ballClump({70, 90, 60}, 40, 2)),
                           packOf(platesAndRods({50, 64, 50})), packOf(reed(240, 4))};
  for (const RawPack& pack : packs) {
    sources.push_back(std::make_unique<HostSource>(bytesOf(pack)));
    assets.push_back(openAsset(*sources.back()));
    ASSERT_TRUE(assets.back()->loadAll());
    ASSERT_TRUE(renderer->add(*assets.back()));
  }
  uploadAll(*renderer);
  std::vector<runtime::Pose> poses;
  std::vector<Instance> instances;
  poses.reserve(24);
  for (int i = 0; i < 24; ++i) {
    const runtime::Asset& asset = *assets[static_cast<std::size_t>(i % 4)];
    poses.push_back(*runtime::Pose::create(asset));
    sway(poses.back(), 0, 1.3f * static_cast<float>(i), 0.25f);
    Instance instance{&asset, &poses.back()};
    const float turn = 0.7f * static_cast<float>(i);
    const float size = 0.6f + 0.05f * static_cast<float>(i % 7);
    instance.to_world = glm::mat4(
        glm::vec4(size * std::cos(turn), 0, size * std::sin(turn), 0), glm::vec4(0, size, 0, 0),
        glm::vec4(-size * std::sin(turn), 0, size * std::cos(turn), 0),
        glm::vec4(0.22f * static_cast<float>(i % 6) - 0.6f, 0, -0.25f * static_cast<float>(i / 6), 1));
    if (i % 5 == 0) instance.to_world[0] = -instance.to_world[0];  // mirrored
    instances.push_back(instance);
  }
  const DepthCanvas canvas(GetParam(), {240, 160}, GL_DEPTH_COMPONENT32F);
  gl::View view = lookAt(canvas.size(), {0.3f, 0.7f, 1.5f}, {-0.1f, 0.35f, -0.3f}, 0.2f, 6.0f);
  const auto draw = [&] {
    canvas.clear();
    const auto drawn = renderer->draw(view, instances);
    ASSERT_TRUE(drawn) << drawn.error().detail;
  };
  draw();
  EXPECT_EQ(compare(view, instances, canvas, 10'000, "finest"), 1);
  view.quality.pixels_per_voxel = 3.0f;
  draw();
  EXPECT_GE(compare(view, instances, canvas, 10'000, "dithered"), 3);
  view.quality.finest_level = 2;
  draw();
  EXPECT_GE(compare(view, instances, canvas, 10'000, "coarse"), 2);
}

KELP_GL_TESTS(PicksTest);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Which level is drawn where.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "canvas.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

class LevelTest : public GlTest {
 protected:
  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const Instance instance_{loaded_.asset.get(), nullptr};
  const Part& part_ = loaded_.asset->pack().parts()[0];

  // How many pixels show each level.
  std::array<int, kMaxLevels> drawnLevels(gl::Renderer& renderer, const Canvas& canvas,
                                          const gl::View& view) {
    canvas.clear();
    EXPECT_TRUE(renderer.draw(view, {&instance_, 1}));
    std::array<int, kMaxLevels> counts{};
    for (const Pixel& pixel : canvas.pixels()) {
      if (pixel[3] != 0) ++counts.at(static_cast<std::size_t>(255 - pixel[3]));
    }
    return counts;
  }
};

TEST_P(LevelTest, VoxelsCoverAsManyPixelsAsWanted) {
  const Canvas canvas({200, 200});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  // Orthographic: the model is 1 high and 80 voxels, so a level-0 voxel has 200 / (2 * half height) / 80
  // pixels.
  for (const float half_height : {0.3f, 0.55f, 0.7f, 0.9f, 1.3f, 1.9f, 2.9f, 5.3f}) {
    for (const float pixels_per_voxel : {0.0f, 0.5f, 1.0f, 3.0f, 5.0f}) {
      gl::View view = orthographic(canvas, {0, 0.5f, 5}, {0, 0.5f, 0}, half_height);
      view.quality.pixels_per_voxel = pixels_per_voxel;
      const double between = pixels_per_voxel == 0
                                 ? 0.0
                                 : std::clamp(std::log2(pixels_per_voxel * 2 * half_height * 80.0 / 200.0),
                                              0.0, part_.levels - 1.0);
      const int level = static_cast<int>(between);
      const double part = between - level;
      // Coarse voxels are fatter: each level by itself has its own number of pixels. A small picture has not
      // all 64 places of the pattern equally often.
      const auto alone = [&](int which) {
        gl::View only = view;
        only.quality.pixels_per_voxel = 0;
        only.quality.finest_level = std::min(which, part_.levels - 1);
        const auto counts = drawnLevels(*renderer, canvas, only);
        return counts[static_cast<std::size_t>(only.quality.finest_level)];
      };
      const int fine = alone(level), coarse = alone(level + 1);
      const auto counts = drawnLevels(*renderer, canvas, view);
      const int all = std::accumulate(counts.begin(), counts.end(), 0);
      const int coarser = counts[static_cast<std::size_t>(level) + 1];
      EXPECT_EQ(counts[static_cast<std::size_t>(level)] + coarser, all)
          << half_height << " " << pixels_per_voxel;
      EXPECT_NEAR(coarser, part * coarse, 2 + 0.03 * all) << half_height << " " << pixels_per_voxel;
      EXPECT_NEAR(all - coarser, (1 - part) * fine, 2 + 0.03 * all) << half_height << " " << pixels_per_voxel;
    }
  }
  // With the eye in the volume something is arbitrarily near.
  gl::View inside = lookAt(canvas, {0, 0.5f, 0.1f}, {0, 0.5f, -1});
  inside.quality.pixels_per_voxel = 100;
  const auto counts = drawnLevels(*renderer, canvas, inside);
  EXPECT_EQ(counts[0], std::accumulate(counts.begin(), counts.end(), 0));
}

TEST_P(LevelTest, EveryPixelsLevelAgreesWithTheCpu) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  for (const float pixels_per_voxel : {0.0f, 1.3f, 2.0f, 3.5f, 8.0f, 200.0f}) {
    gl::View view = lookAt(canvas, {1.1f, 1.2f, 1.8f}, {0, 0.5f, 0});
    view.quality.pixels_per_voxel = pixels_per_voxel;
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
    const std::vector<Pixel> pixels = canvas.pixels();
    int hits = 0;
    int different = 0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const int level = gl::levelAt(view, instance_, 0, {x, y}).value();
        const auto hit = raycast(instance_, pixelRay(view, x, y), level);
        const Pixel& pixel = pixels[static_cast<std::size_t>(160 * y + x)];
        hits += hit.has_value();
        different +=
            hit.has_value() != (pixel[3] != 0) ||
            (hit && (glm::ivec3(pixel[0], pixel[1], pixel[2]) != hit->voxel || 255 - pixel[3] != level));
      }
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LE(different, hits / 200) << pixels_per_voxel;
  }
  EXPECT_EQ(gl::levelAt(lookAt(canvas, {1.1f, 1.2f, 1.8f}, {0, 0.5f, 0}), instance_, 3, {0, 0}),
            std::nullopt);
  EXPECT_EQ(gl::levelAt(gl::View{}, Instance{}, 0, {0, 0}), std::nullopt);
  gl::View negative = lookAt(canvas, {1.1f, 1.2f, 1.8f}, {0, 0.5f, 0});
  negative.quality.finest_level = -1;
  EXPECT_EQ(gl::levelAt(negative, instance_, 0, {0, 0}), std::nullopt);
}

// The arcs of coarser levels are coarser, by half a voxel as drawn, which here is at most two pixels. So what
// a pixel shows is, or lies beside, what the CPU's finest arcs show within that distance.
TEST_P(LevelTest, CoarserArcsMoveNothingFar) {
  const Canvas canvas({160, 120});
  for (const std::size_t named : {3u, 5u, 6u, 7u}) {
    const LoadedAsset swept(sweptPackOf(ballClump({36, 128, 32}, 30, 3), named));
    const Instance instance{swept.asset.get()};
    const auto renderer = makeRenderer(*swept.asset, kVoxelSurface);
    const Box box = bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    for (const float pixels_per_voxel : {2.0f, 4.0f}) {
      gl::View view = lookAt(
          canvas, center + 1.5f * glm::distance(box.min, box.max) * glm::vec3(0.5f, 0.3f, 0.8f), center);
      view.quality.pixels_per_voxel = pixels_per_voxel;
      canvas.clear();
      ASSERT_TRUE(renderer->draw(view, {&instance, 1}));
      const std::vector<Pixel> pixels = canvas.pixels();
      constexpr int kWide = 160, kHigh = 120, kNear = 3;
      std::vector<std::optional<glm::ivec3>> truth(kWide * kHigh);
      int hits = 0, least = kMaxLevels, different = 0, wrong = 0;
      for (int i = 0; i < kWide * kHigh; ++i) {
        const int level = gl::levelAt(view, instance, 0, {i % kWide, i / kWide}).value();
        const auto hit = raycast(instance, pixelRay(view, i % kWide, i / kWide), level);
        least = std::min(least, level);
        if (hit) truth[static_cast<std::size_t>(i)] = hit->voxel << hit->level;
        hits += hit.has_value();
      }
      for (int i = 0; i < kWide * kHigh; ++i) {
        const Pixel& pixel = pixels[static_cast<std::size_t>(i)];
        const int level = 255 - pixel[3];
        bool found = false;
        for (int y = std::max(i / kWide - kNear, 0); y <= std::min(i / kWide + kNear, kHigh - 1); ++y) {
          for (int x = std::max(i % kWide - kNear, 0); x <= std::min(i % kWide + kNear, kWide - 1); ++x) {
            const auto& there = truth[static_cast<std::size_t>(kWide * y + x)];
            if (there.has_value() != (pixel[3] != 0)) continue;
            if (!there) found = true;
            if (!there || found) continue;
            const glm::ivec3 apart = glm::abs(glm::ivec3(pixel[0], pixel[1], pixel[2]) - (*there >> level));
            found = std::max({apart.x, apart.y, apart.z}) <= 1;
          }
        }
        wrong += !found;
        const auto& here = truth[static_cast<std::size_t>(i)];
        different += here.has_value() != (pixel[3] != 0);
      }
      EXPECT_GT(hits, 500);
      EXPECT_GE(least, 1);
      EXPECT_LE(wrong, hits / 200) << named << " " << pixels_per_voxel;
      EXPECT_LE(different, hits / 10) << named << " " << pixels_per_voxel;
    }
  }
}

TEST_P(LevelTest, InstancesOutOfSightAreCulled) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset);
  Instance instances[3] = {instance_, instance_, instance_};
  instances[1].to_world[3] = glm::vec4(50, 0, 0, 1);  // beside
  instances[2].to_world[3] = glm::vec4(0, 0, 5, 1);   // behind the eye
  const auto stats = renderer->draw(lookAt(canvas, {0, 0.5f, 3}, {0, 0.5f, 0}), instances);
  ASSERT_TRUE(stats);
  EXPECT_EQ(stats->instances, 1u);
  EXPECT_EQ(stats->culled, 2u);
  EXPECT_EQ(stats->draws, 1u);
}

KELP_GL_TESTS(LevelTest);

}  // namespace
}  // namespace kelp::test

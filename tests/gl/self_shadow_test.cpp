// SPDX-License-Identifier: MIT
// Self-shadow and ambient occlusion, against geometry that has a formula and against rays on the CPU.
#include <cmath>
#include <random>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// A surface that shows how much of sun and sky is visible.
constexpr char kVisible[] = "vec4 kelpSurface(KelpSurface s) { return vec4(kelpVisible(s), 0.0, 1.0); }\n";

// A volume that is solid where `inside`, at the voxels' centers; normals of the surface are `up`.
template <class Inside>
LoadedAsset solid(const glm::ivec3& size, Inside&& inside, const glm::vec3& up) {
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        volume.solid[volume.index({x, y, z})] = inside(glm::vec3(x, y, z) + 0.5f);
  RawPack pack = packOf(volume);
  std::vector<fields::SurfaceVoxel> surface =
      fields::surfaceVoxels(volume, 1).empty() ? std::vector<fields::SurfaceVoxel>() : plainSurface(volume);
  for (fields::SurfaceVoxel& voxel : surface) voxel.attribute = makeAttribute(0, encodeNormal(up));
  pack.parts[0].levels[0] = fields::buildLevel(volume, surface, 1);
  return LoadedAsset(pack);
}

// Where rays start from a hit, as documented: off the surface, by half as much where that is in a solid.
glm::vec3 startOf(const Instance& instance, const runtime::Hit& hit, float voxel) {
  float lift = 1.75f * voxel;
  for (int halvings = 0; halvings < 3; ++halvings) {
    const auto here = raycast(instance, {hit.position + lift * hit.normal, hit.normal, 1e-6f});
    if (!here || here->t > 0) break;
    lift *= 0.5f;
  }
  return hit.position + lift * hit.normal;
}

class SelfShadowTest : public GlTest {
 protected:
  std::vector<Pixel> draw(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view,
                          const Instance& instance) {
    canvas.clear();
    const auto drawn = renderer.draw(view, {&instance, 1});
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    return canvas.pixels();
  }
};

// A long wall of height h on a floor hides (1 - x / sqrt(x^2 + h^2)) / 2 of the cosine-weighted sky from a
// point at the distance x (the form factor of an infinite perpendicular strip). Seen from above, so that
// columns of pixels have one x.
TEST_P(SelfShadowTest, AWallHidesItsFormFactorOfTheSky) {
  const int kWall = 32, kHeight = 24;
  const LoadedAsset loaded =
      solid({96, 32, 256}, [=](const glm::vec3& p) { return p.y < 4 || (p.x < kWall && p.y < 4 + kHeight); },
            {0, 1, 0});
  const auto renderer = makeRenderer(*loaded.asset, kVisible);
  const Canvas canvas({96, 64});  // a pixel a voxel, the middle of the length
  gl::View view = orthographic(canvas, {0, 5, 0.001f}, {0, 0, 0}, 1.0f, 0.1f, 10);
  view.quality.occlusion_rays = 16;
  view.quality.occlusion_reach = 8;
  for (const gl::Shading shading : {gl::Shading::kFaces, gl::Shading::kGradient}) {
    view.quality.shading = shading;
    const std::vector<Pixel> pixels = draw(*renderer, canvas, view, {loaded.asset.get(), nullptr});
    // Rays start above the floor: from there the wall is lower.
    const double h = kHeight - (shading == gl::Shading::kFaces ? 0.0625 : 1.75);
    for (int x = kWall + 4; x < 92; x += 4) {
      double sum = 0;
      for (int y = 0; y < 64; ++y) {
        for (int dx = -2; dx < 2; ++dx) sum += pixels[static_cast<std::size_t>(96 * y + x + dx)][1] / 255.0;
      }
      double expected = 0;
      for (int dx = -2; dx < 2; ++dx) {
        const double d = x + dx + 0.5 - kWall;
        expected += 0.25 * (1 - 0.5 * (1 - d / std::sqrt(d * d + h * h)));
      }
      EXPECT_NEAR(sum / 256, expected, 0.025) << x;
    }
    // On top of the wall nothing hides the sky.
    for (int x = 4; x < kWall - 2; ++x) EXPECT_EQ(pixels[static_cast<std::size_t>(96 * 32 + x)][1], 255) << x;
  }
}

// The mean over the pixels of a bent clump is that of many random rays on the CPU, hits weighted as
// documented. Any number of rays has that mean.
TEST_P(SelfShadowTest, OcclusionIsTheMeanOfRaysOnTheCpu) {
  const LoadedAsset loaded(packOf(ballClump({60, 80, 50}, 40, 2)));
  runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
  const std::vector<Knot> knots = figureKnots(kFigure6[1]);
  (void)pose.setKnots(0, knots);
  Instance instance{loaded.asset.get(), &pose};
  instance.to_world = glm::rotate(glm::scale(glm::mat4(1), glm::vec3(1.5f)), 0.7f, glm::vec3(0, 1, 0));
  const auto renderer = makeRenderer(*loaded.asset, kVisible);
  const Canvas canvas({80, 60});
  const Box box = bounds(instance);
  const glm::vec3 center = 0.5f * (box.min + box.max);
  gl::View view =
      lookAt(canvas, center + glm::distance(box.min, box.max) * glm::vec3(0.5f, 0.4f, 0.7f), center);
  view.quality.occlusion_reach = 0.4f;
  const float voxel = 1.5f / 80, reach = 0.4f * 80 * voxel;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  double expected = 0;
  int count = 0;
  for (int i = 0; i < 80 * 60; ++i) {
    const auto hit = raycast(instance, pixelRay(view, i % 80, i / 80));
    if (!hit) continue;
    const glm::vec3 start = startOf(instance, *hit, voxel);
    const glm::vec3 across = glm::normalize(glm::cross(hit->normal, glm::vec3(0.31f, 0.52f, 0.79f))),
                    beside = glm::cross(hit->normal, across);
    for (int n = 0; n < 32; ++n) {
      const float r = std::sqrt(unit(random)), angle = 6.2831853f * unit(random);
      const glm::vec3 direction =
          r * (std::cos(angle) * across + std::sin(angle) * beside) + std::sqrt(1 - r * r) * hit->normal;
      const auto stop = raycast(instance, {start, direction, reach});
      expected += stop ? std::pow(stop->t / reach, 2.0f) : 1.0f;
      ++count;
    }
  }
  ASSERT_GT(count, 15000);
  expected /= count;
  EXPECT_LT(expected, 0.9);  // there is something to see
  for (const int rays : {1, 4, 16}) {
    view.quality.occlusion_rays = rays;
    const std::vector<Pixel> pixels = draw(*renderer, canvas, view, instance);
    double sum = 0;
    int covered = 0;
    for (const Pixel& pixel : pixels) {
      if (pixel[3] == 0) continue;
      sum += pixel[1] / 255.0;
      ++covered;
    }
    EXPECT_NEAR(sum / covered, expected, rays == 1 ? 0.02 : 0.01) << rays;
    EXPECT_EQ(draw(*renderer, canvas, view, instance), pixels) << "the same again";
  }
}

// The shadow's edge is where rays on the CPU say it is: pixel by pixel, sun from both sides.
TEST_P(SelfShadowTest, ShadowsAreThoseOfRaysOnTheCpu) {
  const LoadedAsset loaded(packOf(ballClump({60, 80, 50}, 40, 2)));
  runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
  const std::vector<Knot> knots = figureKnots(kFigure6[1]);
  (void)pose.setKnots(0, knots);
  Instance instance{loaded.asset.get(), &pose};
  instance.to_world =
      glm::scale(glm::translate(glm::mat4(1), glm::vec3(3, 0, 0)), glm::vec3(-0.5f, 0.5f, 0.5f));
  const float voxel = 0.5f / 80;
  const auto renderer = makeRenderer(*loaded.asset, kVisible);
  const Canvas canvas({160, 120});
  const Box box = bounds(instance);
  const glm::vec3 center = 0.5f * (box.min + box.max);
  gl::View view =
      lookAt(canvas, center + 0.8f * glm::distance(box.min, box.max) * glm::vec3(0.5f, 0.4f, 0.7f), center);
  view.quality.self_shadow = true;
  for (const glm::vec3& sun :
       {glm::normalize(glm::vec3(0.5f, 0.8f, 0.4f)), glm::normalize(glm::vec3(-0.7f, 0.2f, 0.1f))}) {
    view.light.sun_direction = 3.0f * sun;
    const std::vector<Pixel> pixels = draw(*renderer, canvas, view, instance);
    int lit = 0, dark = 0, wrong = 0;
    for (int i = 0; i < 160 * 120; ++i) {
      const auto hit = raycast(instance, pixelRay(view, i % 160, i / 160));
      const Pixel& pixel = pixels[static_cast<std::size_t>(i)];
      if (!hit || pixel[3] == 0) continue;
      ASSERT_TRUE(pixel[0] == 0 || pixel[0] == 255);
      ASSERT_EQ(pixel[1], 255);  // no rays of occlusion
      const float facing = glm::dot(hit->normal, sun);
      if (facing < 0.01f) {
        if (facing < -0.16f) {
          ASSERT_EQ(pixel[0], 255);  // no light to stop: not traced
        }
        continue;
      }
      const bool shaded = raycast(instance, {startOf(instance, *hit, voxel), sun}).has_value();
      shaded ? ++dark : ++lit;
      wrong += (pixel[0] == 0) != shaded;
    }
    EXPECT_GT(lit, 600);
    EXPECT_GT(dark, 200);
    EXPECT_LE(wrong, (lit + dark) / 100);
  }
}

// Off, which is the default, nothing changes; on, kelp's own look has shadows in it.
TEST_P(SelfShadowTest, TheDefaultLookHasThemWhenAskedFor) {
  const LoadedAsset loaded(packOf(ballClump({60, 80, 50}, 40, 2)));
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto renderer = makeRenderer(*loaded.asset, nullptr, config);
  const auto without = makeRenderer(*loaded.asset);
  const Canvas canvas({80, 60});
  gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.6f}, {0, 0.5f, 0});
  const Instance instance{loaded.asset.get(), nullptr};
  const std::vector<Pixel> plain = draw(*renderer, canvas, view, instance);
  const auto compare = [&](const std::vector<Pixel>& other) {
    int darker = 0, brighter = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      darker += other[i][1] < plain[i][1];
      brighter += other[i][1] > plain[i][1];
    }
    EXPECT_EQ(brighter, 0);
    return darker;
  };
  EXPECT_EQ(draw(*without, canvas, view, instance), plain);
  view.quality.self_shadow = true;
  const auto refused = without->draw(view, {&instance, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kMisuse);
  const int shadowed = compare(draw(*renderer, canvas, view, instance));
  EXPECT_GT(shadowed, 30);
  view.quality.occlusion_rays = 16;
  EXPECT_GT(compare(draw(*renderer, canvas, view, instance)), 2 * shadowed);
  view.quality.self_shadow = false;
  view.quality.occlusion_rays = 0;
  EXPECT_EQ(draw(*renderer, canvas, view, instance), plain);
  view.quality.occlusion_rays = 17;
  EXPECT_FALSE(renderer->draw(view, {&instance, 1}));
  view.quality.occlusion_rays = -1;
  EXPECT_FALSE(renderer->draw(view, {&instance, 1}));
}

KELP_GL_TESTS(SelfShadowTest);

}  // namespace
}  // namespace kelp::test

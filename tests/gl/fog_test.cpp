// SPDX-License-Identifier: MIT
// Fog against the integral that it stands for, in double precision; among solids and the host's own depth;
// and that nothing about a step is to be chosen.
#include <cmath>

#include "fog_canvas.h"

namespace kelp::test {
namespace {

constexpr glm::ivec3 kFogSize(40, 56, 36);

class Fog : public GlTest {};

TEST_P(Fog, IsTheIntegralInEveryPose) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({16, 12});
  for (const bool glows : {false, true}) {
    const RawPack pack =
        fogPack(fogOf(kFogSize, puffs,
                      glows ? FogShape([](const glm::dvec3& p) { return puffs(p) * p.y; }) : FogShape()),
                0.21f);
    const LoadedAsset loaded(pack);
    const auto renderer = makeRenderer(*loaded.asset);
    ASSERT_TRUE(renderer);
    for (const int level : {0, 1}) {
      const FogTruth truth(pack.parts[0], level);
      std::vector<FigurePose> poses(kFigure6.begin(), kFigure6.end());
      // where a curve begins without a slope
      poses.push_back({"at rest at both ends", {0, 0, 0}, {0, 0, 0}});
      poses.push_back({"at rest at one end", {0, 0, 0}, {2, 1, -1}});
      for (const FigurePose& figure : poses) {
        SCOPED_TRACE(std::string(figure.name) + " level " + std::to_string(level));
        auto pose = runtime::Pose::create(*loaded.asset);
        ASSERT_TRUE(pose);
        const std::vector<Knot> knots = figureKnots(figure);
        (void)pose->setKnots(0, knots);
        const Instance instance{loaded.asset.get(), &*pose};
        gl::View view = dark(framing(canvas.size(), instance));
        const Box bounds = deformedBounds(knots, kFogSize);
        view.quality.finest_level = level;
        const std::vector<glm::vec4> drawn = drawFog(*renderer, canvas, view, instance);
        double worst = 0, worst_glow = 0, sum = 0;
        for (int y = 0; y < canvas.size().y; ++y) {
          for (int x = 0; x < canvas.size().x; ++x) {
            const PartRay ray = partRay(view, instance, bounds, x, y);
            const FogSight sight = ray.begin < ray.end
                                       ? truth.look(knots, ray.o, ray.r, ray.begin, ray.end, 1.0 / 12)
                                       : FogSight();
            const glm::vec4& pixel = drawn[static_cast<std::size_t>(x + canvas.size().x * y)];
            worst = std::max(worst, std::abs(1 - sight.through - double{pixel.a}));
            for (int c = 0; c < 3; ++c)
              worst_glow = std::max(worst_glow, std::abs(sight.glow[c] - double{pixel[c]}));
            sum += 1 - sight.through;
          }
        }
        EXPECT_GT(sum, 0.01);
        EXPECT_LT(worst, 2.5e-4);  // a sixteenth of what 8 bits tell apart
        EXPECT_LT(worst_glow, 2.0 / 255);
      }
    }
  }
}

// Where fog is dense to the faces of its volume, it ends there, and not half a voxel beyond.
TEST_P(Fog, EndsAtTheFacesOfItsVolume) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({16, 12});
  const RawPack pack = fogPack(fogOf(kFogSize, [](const glm::dvec3&) { return 1.0; }), 0.03f);
  const LoadedAsset loaded(pack);
  const auto renderer = makeRenderer(*loaded.asset);
  ASSERT_TRUE(renderer);
  auto pose = runtime::Pose::create(*loaded.asset);
  ASSERT_TRUE(pose);
  const std::vector<Knot> knots = figureKnots(kFigure6[2]);
  (void)pose->setKnots(0, knots);
  const Instance instance{loaded.asset.get(), &*pose};
  gl::View view = dark(framing(canvas.size(), instance));
  for (const int level : {0, 1}) {
    view.quality.finest_level = level;
    const FogTruth truth(pack.parts[0], level);
    const std::vector<glm::vec4> drawn = drawFog(*renderer, canvas, view, instance);
    for (int y = 0; y < canvas.size().y; ++y) {
      for (int x = 0; x < canvas.size().x; ++x) {
        const PartRay ray = partRay(view, instance, deformedBounds(knots, kFogSize), x, y);
        const double through =
            ray.begin < ray.end ? truth.look(knots, ray.o, ray.r, ray.begin, ray.end, 1.0 / 32).through : 1;
        EXPECT_NEAR(drawn[static_cast<std::size_t>(x + canvas.size().x * y)].a, 1 - through, 2e-3);
      }
    }
  }
}

// Solid parts hide what of the fog is behind them, and are seen through what is before them; the depth buffer
// stays as it was.
TEST_P(Fog, EndsAtTheDepthSoFar) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({48, 64});
  const float extinction = 0.05f;
  const RawPack pack = fogPack(fogOf(kFogSize, [](const glm::dvec3&) { return 1.0; }), extinction);
  const LoadedAsset fog(pack),
      wall(packOf({glm::ivec3(40, 56, 4), std::vector<std::uint8_t>(40 * 56 * 4, 1)}));
  const auto renderer = makeRenderer(*fog.asset);
  ASSERT_TRUE(renderer && renderer->add(*wall.asset) && renderer->upload(~std::uint64_t{0}));
  const gl::View view = dark(orthographic(canvas.size(), {0, 0.5f, 3}, {0, 0.5f, 0}, 0.45f));
  const float voxel = 1.0f / 56;
  for (const float z : {-0.6f, -8 * voxel, 0.0f, 12 * voxel, 0.6f}) {
    Instance both[2] = {{fog.asset.get(), nullptr}, {wall.asset.get(), nullptr}};
    both[1].to_world[3].z = z;
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, both));
    const std::vector<glm::vec4> solid = canvas.pixels();
    std::vector<float> depth(solid.size()), depth_after(solid.size());
    glReadPixels(0, 0, canvas.size().x, canvas.size().y, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    ASSERT_TRUE(renderer->draw(view, both, gl::Pass::kFog));
    const std::vector<glm::vec4> drawn = canvas.pixels();
    glReadPixels(0, 0, canvas.size().x, canvas.size().y, GL_DEPTH_COMPONENT, GL_FLOAT, depth_after.data());
    EXPECT_EQ(depth, depth_after);
    // The wall's front; fog between it and the fog's own.
    const double before = std::clamp(18.0 - (double{z} / voxel + 2.0), 0.0, 36.0);
    const std::size_t middle = static_cast<std::size_t>(24 + 48 * 32);
    ASSERT_EQ(solid[middle].a, 1.0f);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(drawn[middle][c], double{solid[middle][c]} * std::exp(-double{extinction} * before), 2e-4)
          << z;
    EXPECT_NEAR(drawn[middle].a, 1.0f, 1e-6);
  }
  // A host's own texture of the depth, and reversed depths, take the same way as for solids:
  // composition_test.cpp. Multisampled, the depth test decides.
  const FloatCanvas multisampled(canvas.size(), 4);
  Instance both[2] = {{fog.asset.get(), nullptr}, {wall.asset.get(), nullptr}};
  both[1].to_world[3].z = 0.6f;
  multisampled.clear();
  ASSERT_TRUE(renderer->draw(view, both));
  EXPECT_TRUE(renderer->draw(view, both, gl::Pass::kFog));
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

// Far away, where a step of the depth buffer is long, and in either convention: nothing of the fog behind a
// wall comes before it.
TEST_P(Fog, EndsAtTheDepthSoFarFarAway) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({48, 64});
  const float extinction = 0.3f;
  const LoadedAsset fog(fogPack(fogOf(kFogSize, [](const glm::dvec3&) { return 1.0; }), extinction)),
      wall(packOf({glm::ivec3(40, 56, 4), std::vector<std::uint8_t>(40 * 56 * 4, 1)}));
  const auto renderer = makeRenderer(*fog.asset);
  ASSERT_TRUE(renderer && renderer->add(*wall.asset) && renderer->upload(~std::uint64_t{0}));
  constexpr float kSide = 20;  // meters
  for (const bool reversed : {false, true}) {
    gl::View view = dark(lookAt(canvas.size(), {0, 0.5f * kSide, 100}, {0, 0.5f * kSide, 0}, 0.1f, 1000.0f));
    view.camera.reversed_depth = reversed;
    if (reversed) {
      view.camera.eye_to_clip[2][2] = -view.camera.eye_to_clip[2][2];
      view.camera.eye_to_clip[3][2] = -view.camera.eye_to_clip[3][2];
    }
    Instance both[2] = {{fog.asset.get(), nullptr}, {wall.asset.get(), nullptr}};
    for (Instance& instance : both) instance.to_world = glm::mat4(glm::mat3(kSide));
    both[1].to_world[3].z = 0.4f * kSide;  // before the fog
    glClearDepth(reversed ? 0.0 : 1.0);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glClearDepth(1.0);
    ASSERT_TRUE(renderer->draw(view, both));
    const std::vector<glm::vec4> solid = canvas.pixels();
    ASSERT_EQ(solid[24 + 48 * 32].a, 1.0f);
    ASSERT_TRUE(renderer->draw(view, both, gl::Pass::kFog));
    const std::vector<glm::vec4> drawn = canvas.pixels();
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(drawn[24 + 48 * 32][c], solid[24 + 48 * 32][c], 1e-3) << reversed;
  }
}

// Two clouds, one behind the other, in either order of the list.
TEST_P(Fog, IsBlendedFarToNear) {
  const Canvas canvas({24, 24});
  const LoadedAsset loaded(fogPack(fogOf({16, 16, 16}, [](const glm::dvec3&) { return 1.0; }), 0.1f));
  const auto renderer = makeRenderer(*loaded.asset);
  ASSERT_TRUE(renderer);
  const gl::View view = orthographic(canvas, {0, 0.5f, 5}, {0, 0.5f, 0}, 0.4f);
  Instance near{loaded.asset.get(), nullptr}, far = near;
  near.to_world[3].z = 1.5f;
  near.tint = {1, 0, 0, 1};
  far.tint = {0, 1, 0, 1};
  std::vector<Pixel> pictures[2];
  for (int order = 0; order < 2; ++order) {
    canvas.clear();
    const Instance both[2] = {order == 0 ? near : far, order == 0 ? far : near};
    const auto drawn = renderer->draw(view, both, gl::Pass::kFog);
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->draws, 1u);
    EXPECT_EQ(drawn->instances, 2u);
    pictures[order] = canvas.pixels();
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  // exp(-1.6) of the far one's light comes through the near one.
  const Pixel& middle = pictures[0][12 * 24 + 12];
  EXPECT_GT(middle[0], 0);
  EXPECT_NEAR(middle[1] / std::exp(-1.6) * 0.9 / 0.8, middle[0], 6.0);
  EXPECT_NEAR(middle[3], 255 * (1 - std::exp(-3.2)), 1.0);
  // The other passes do not draw fog.
  canvas.clear();
  const Instance both[2] = {near, far};
  const auto solid = renderer->draw(view, both);
  ASSERT_TRUE(solid);
  EXPECT_EQ(solid->instances, 0u);
}

// While finer pages are missing, the coarser ones are drawn in their place: the mass is there from the first
// level on.
TEST_P(Fog, IsCoarserUntilItsPagesAreThere) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const LoadedAsset loaded(fogPack(fogOf({70, 90, 66}, puffs), 0.1f));
  const auto renderer = makeRenderer(*loaded.asset);
  ASSERT_TRUE(renderer);
  expectCoarserUntilLoaded(*renderer, *loaded.asset);
}

// One text for both: but for the rounding of eight bits.
TEST_P(Fog, IsTheSameInBothApis) {
  static std::vector<Pixel> first;
  const Canvas canvas({40, 48});
  const LoadedAsset loaded(
      fogPack(fogOf(kFogSize, puffs, [](const glm::dvec3& p) { return puffs(p) * p.x; }), 0.1f));
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto renderer = makeRenderer(*loaded.asset, nullptr, config);
  ASSERT_TRUE(renderer);
  const Instance instance{loaded.asset.get(), nullptr};
  gl::View view = framing(canvas.size(), instance);
  view.quality.self_shadow = true;
  ASSERT_TRUE(renderer->draw(view, {&instance, 1}, gl::Pass::kFog));
  const std::vector<Pixel> shaded = canvas.pixels();
  canvas.clear();
  view.quality.self_shadow = false;
  ASSERT_TRUE(renderer->draw(view, {&instance, 1}, gl::Pass::kFog));
  const std::vector<Pixel> lit = canvas.pixels();
  double sums[2] = {};
  for (std::size_t i = 0; i < lit.size(); ++i) {
    EXPECT_EQ(lit[i][3], shaded[i][3]);
    // a shadow takes light, and gives none
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(shaded[i][c], lit[i][c] + 1);
    sums[0] += lit[i][0];
    sums[1] += shaded[i][0];
  }
  EXPECT_LT(sums[1], 0.99 * sums[0]);
  if (first.empty()) {
    first = shaded;
  } else {
    EXPECT_EQ(first, shaded);
  }
}

}  // namespace

KELP_GL_TESTS(Fog);

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Occlusion, soft shadows and kelpDistance: against rays in double precision, geometry that has a formula,
// and brute force.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "../runtime/swept_truth.h"
#include "canvas.h"
#include "distance_probe.h"
#include "kelp/runtime/pose.h"
#include "light_truth.h"
#include "reference/sweep_trials.h"
#include "support/distance_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

runtime::AssetOptions loadDistances(int level = 0) {
  runtime::AssetOptions options;
  options.distance_level = level;
  return options;
}
gl::RendererOptions withDistances() {
  gl::RendererOptions config;
  config.features = gl::Features::kDistances;
  return config;
}

// All surfaces face up.
RawPart facingUp(const fields::Occupancy& volume, const std::string& name) {
  RawPart part = partOf(volume, figureKnots(kFigure6[0]), name);
  std::vector<fields::SurfaceVoxel> surface = plainSurface(volume);
  for (fields::SurfaceVoxel& voxel : surface) voxel.attribute = makeAttribute(0, encodeNormal({0, 1, 0}));
  part.levels[0] = fields::buildLevel(volume, surface, 1);
  part.distances = distancesOf(volume, static_cast<int>(part.levels.size()));
  return part;
}

class DistanceShadingTest : public GlTest {
 protected:
  std::vector<Pixel> draw(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view,
                          const Instance& instance) {
    canvas.clear();
    const auto drawn = renderer.draw(view, {&instance, 1});
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    return canvas.pixels();
  }
};

// A clump of balls in some poses of Figure 6, with the sun high to the right.
struct Clump {
  explicit Clump(const FigurePose& figure, const runtime::Asset& asset, const Canvas& canvas)
      : pose(*runtime::Pose::create(asset)), instance{&asset, &pose} {
    EXPECT_TRUE(pose.setKnots(0, figureKnots(figure)));
    instance.to_world = glm::rotate(glm::scale(glm::mat4(1), glm::vec3(1.5f)), 0.7f, glm::vec3(0, 1, 0));
    const Box box = bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    view =
        lookAt(canvas, center + 0.7f * glm::distance(box.min, box.max) * glm::vec3(0.5f, 0.4f, 0.7f), center);
    view.light.sun_direction = {0.1f, 0.9f, 0.3f};
    view.quality.occlusion_reach = kReach;
  }
  runtime::Pose pose;
  Instance instance;
  gl::View view;
};
fields::Occupancy clump() { return ballClump({144, 192, 120}, 16, 5); }
constexpr std::size_t kClumpPoses[] = {0, 1, 3};

TEST_P(DistanceShadingTest, OcclusionErrsLittleMoreThanEightRays) {
  const fields::Occupancy volume = clump();
  const LoadedAsset loaded(distancePackOf(volume), loadDistances());
  const auto renderer = makeRenderer(*loaded.asset, kVisible, withDistances());
  const auto eight = makeRenderer(*loaded.asset, kEightSunRays, withDistances());
  const Canvas canvas({192, 160});
  for (const std::size_t i : kClumpPoses) {
    const FigurePose& figure = kFigure6[i];
    Clump posed(figure, *loaded.asset, canvas);
    gl::View& view = posed.view;
    view.quality.occlusion_rays = 8;
    LightPictures pictures;
    pictures.rays = draw(*renderer, canvas, view, posed.instance);
    pictures.sun_rays = draw(*eight, canvas, view, posed.instance);
    view.quality.occlusion = true;
    view.quality.soft_shadows = kSunDegrees;
    pictures.distances = draw(*renderer, canvas, view, posed.instance);
    const LightErrors errors = measureLight(LightSurfaces(volume, posed.instance, view, pictures.distances),
                                            pictures, allTests() ? 20000 : shareOf(900));
    EXPECT_GT(errors.sun.count, 30) << figure.name;
    EXPECT_GT(errors.sun.shade, 0.03) << figure.name;
    EXPECT_LT(errors.sun.distances, 0.1 * errors.sun.shade) << figure.name;
    if (i == 0) {
      EXPECT_LE(errors.sky.distances, 1.5 * errors.sky.rays);
    }
    EXPECT_LE(errors.sky.distances, 0.5 * errors.sky.shade) << figure.name;  // all of it without occlusion
  }
}

// In the penumbrae alone, which are few pixels: elsewhere every method is right.
TEST_P(DistanceShadingTest, PenumbraeErrNoMoreThanThoseOfEightRays) {
  const fields::Occupancy volume = clump();
  const LoadedAsset loaded(distancePackOf(volume), loadDistances());
  const auto renderer = makeRenderer(*loaded.asset, kVisible, withDistances());
  const auto eight = makeRenderer(*loaded.asset, kEightSunRays, withDistances());
  const Canvas canvas({768, 640});
  double by_rays = 0, by_distances = 0;
  for (const std::size_t i : kClumpPoses) {
    const FigurePose& figure = kFigure6[i];
    Clump posed(figure, *loaded.asset, canvas);
    const std::vector<Pixel> rays = draw(*eight, canvas, posed.view, posed.instance);
    posed.view.quality.soft_shadows = kSunDegrees;
    const std::vector<Pixel> distances = draw(*renderer, canvas, posed.view, posed.instance);
    const LightErrors::Of errors = measurePenumbra(volume, posed.instance, posed.view, rays, distances);
    EXPECT_GT(errors.count, 30) << figure.name;
    EXPECT_GT(errors.shade, 0.3) << figure.name;  // the mean of penumbrae is about a half
    EXPECT_LE(errors.distances, 1.1 * errors.rays) << figure.name;
    by_rays += errors.count * errors.rays;
    by_distances += errors.count * errors.distances;
  }
  EXPECT_LE(by_distances, by_rays);
}

// As SelfShadowTest.AWallHidesItsFormFactorOfTheSky; a wall 32 voxels wide on a floor, seen from above.
constexpr int kWall = 32;
fields::Occupancy floorAndWall(bool wall) {
  return voxelsWhere({96, 32, 160},
                     [=](const glm::ivec3& v) { return v.y < 4 || (wall && v.x < kWall && v.y < 28); });
}

TEST_P(DistanceShadingTest, PartsOfAnInstanceShadeEachOther) {
  RawPack one = packOf(floorAndWall(true)), two = one;
  one.parts = {facingUp(floorAndWall(true), "both")};
  two.parts = {
      facingUp(floorAndWall(false), "floor"),
      facingUp(voxelsWhere({kWall, 32, 160}, [](const glm::ivec3& v) { return v.y >= 4 && v.y < 28; }),
               "wall")};
  two.parts[1].to_object[3].x -= 1;  // 32 voxels
  const LoadedAsset together(one, loadDistances()), apart(two, loadDistances());
  const Canvas canvas({96, 64});
  gl::View view = orthographic(canvas, {0, 5, 0.001f}, {0, 0, 0}, 1.0f, 0.1f, 10);
  view.light.sun_direction = {-1, 1, 0};
  view.quality.occlusion_reach = 0.3f;
  view.quality.occlusion = true;
  view.quality.soft_shadows = 4;
  const auto renderer = makeRenderer(*together.asset, kVisible, withDistances());
  ASSERT_TRUE(renderer->add(*apart.asset));
  ASSERT_TRUE(renderer->upload(~std::uint64_t{0}));
  const std::vector<Pixel> whole = draw(*renderer, canvas, view, {together.asset.get(), nullptr});
  const std::vector<Pixel> parts = draw(*renderer, canvas, view, {apart.asset.get(), nullptr});
  const auto at = [](const std::vector<Pixel>& pixels, int x) {
    return pixels[static_cast<std::size_t>(96 * 32 + x)];
  };
  // A straight edge before a disc 4 degrees wide, 45 degrees up. Rays start 1.75 voxels above the floor.
  for (int x = kWall + 3; x < 94; ++x) {
    double seen = 0;
    for (int y = 0; y < 64; ++y) seen += whole[static_cast<std::size_t>(96 * y + x)][0] / (255.0 * 64);
    const double up = glm::degrees(std::atan2(24 - 1.75, x + 0.5 - kWall));
    const double u = glm::clamp((up - 45) / 2, -1.0, 1.0);
    EXPECT_NEAR(seen, 0.5 - (u * std::sqrt(1 - u * u) + std::asin(u)) / std::numbers::pi, 0.1) << x;
  }
  EXPECT_LT(at(whole, kWall + 3)[1], 200);
  EXPECT_GT(at(whole, 90)[1], 230);
  int different = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (std::size_t c = 0; c < 2; ++c) different += std::abs(whole[i][c] - parts[i][c]) > 26;
  }
  EXPECT_LT(different, 200);  // of 12,288, where wall and floor meet
  // The wall shades where it is not seen itself: a narrow view of the floor beside it.
  gl::View narrow = orthographic({96, 64}, {-0.1f, 5, 0.001f}, {-0.1f, 0, 0}, 0.1f, 0.1f, 10);
  narrow.light = view.light;
  narrow.quality = view.quality;
  const std::vector<Pixel> beside = draw(*renderer, canvas, narrow, {apart.asset.get(), nullptr});
  int dark = 0;
  for (const Pixel& pixel : beside) dark += pixel[3] != 0 && pixel[0] == 0;
  EXPECT_GT(dark, 1000);
}

TEST_P(DistanceShadingTest, WithoutDistancesNothingIsOccludedAndWithoutAWishNothingChanges) {
  const RawPack pack = distancePackOf(ballClump({60, 80, 50}, 20, 2));
  const LoadedAsset without(pack), with(pack, loadDistances());
  const Canvas canvas({96, 64});
  gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  const auto plain = makeRenderer(*without.asset);
  const std::vector<Pixel> expected = draw(*plain, canvas, view, {without.asset.get(), nullptr});
  const auto renderer = makeRenderer(*with.asset, nullptr, withDistances());
  ASSERT_TRUE(renderer->add(*without.asset));
  ASSERT_TRUE(renderer->upload(~std::uint64_t{0}));
  EXPECT_EQ(draw(*renderer, canvas, view, {with.asset.get(), nullptr}), expected);
  view.quality.occlusion = true;
  view.quality.soft_shadows = 1;
  EXPECT_NE(draw(*renderer, canvas, view, {with.asset.get(), nullptr}), expected);
  view.quality.soft_shadows = 0;
  EXPECT_NE(draw(*renderer, canvas, view, {with.asset.get(), nullptr}), expected);
  EXPECT_EQ(draw(*renderer, canvas, view, {without.asset.get(), nullptr}), expected);

  const Instance instance{without.asset.get(), nullptr};
  EXPECT_EQ(plain->draw(view, {&instance, 1}).error().code, ErrorCode::kMisuse);
  view.quality.soft_shadows = 21;
  EXPECT_EQ(renderer->draw(view, {&instance, 1}).error().code, ErrorCode::kMisuse);
  // The pool holds them, and gives them back.
  EXPECT_GT(gl::poolBytes(*with.asset, gl::Features::kDistances), gl::poolBytes(*with.asset));
  EXPECT_EQ(gl::poolBytes(*without.asset, gl::Features::kDistances), gl::poolBytes(*without.asset));
}

// At points of planes through and beside a bent clump: against brute force over cubes in double precision.
TEST_P(DistanceShadingTest, KelpDistanceIsThatToTheVoxels) {
  const fields::Occupancy volume = ballClump({48, 64, 40}, 8, 4);
  const reference::SweepRig curl = reference::namedSweeps(volume.size)[6];
  RawPack swept_pack = distancePackOf(volume, curl.knots);
  swept_pack.parts[0].bend = Bend::kSweep;
  const LoadedAsset loaded(distancePackOf(volume), loadDistances()), swept(swept_pack, loadDistances());
  const auto renderer = makeRenderer(*loaded.asset, nullptr, withDistances());
  ASSERT_TRUE(renderer->add(*swept.asset) && renderer->upload(~std::uint64_t{0}));
  const GLuint program = distanceProgram(GetParam(), *renderer);
  ASSERT_NE(program, 0u);
  const Layers layers(volume);
  const Canvas canvas({64, 64});
  for (const std::size_t i : {0u, 1u, 2u}) {  // at rest, bent, swept
    runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
    const std::vector<Knot> knots = i == 2 ? curl.knots : figureKnots(kFigure6[i]);
    ASSERT_TRUE(i == 2 || pose.setKnots(0, knots));
    Instance instance{loaded.asset.get(), &pose};
    if (i == 2) instance = {swept.asset.get()};
    instance.to_world = glm::rotate(glm::mat4(1), 0.6f, glm::vec3(0.2f, 1, 0.1f));
    std::unique_ptr<SolidTruth> truth;
    if (i == 2)
      truth = std::make_unique<SweptTruth>(layers, knots, curl.roll);
    else
      truth = std::make_unique<BentTruth>(layers, knots);
    const DistanceErrors errors = measureDistances(*renderer, program, canvas, instance, *truth);
    EXPECT_GT(errors.inside, 4);
    EXPECT_LT(errors.most_inside, 0.9);
    EXPECT_GT(errors.near, 30);
    // Near the surface it is right; farther away coarser voxels say that something is nearer.
    EXPECT_LT(errors.worst, i == 0 ? 1 : 2.5);
    EXPECT_GT(errors.share(0.02), i == 0 ? 0.5 : 0.2);
    EXPECT_GT(errors.share(0.5), 0.8);
    EXPECT_LT(errors.share(0.98), i == 0 ? 1.1 : 1.6);
  }
  glDeleteProgram(program);
}

KELP_GL_TESTS(DistanceShadingTest);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Parts that are drawn through cages, against the same parts without, which splines bend, and against
// raycast().
#include <random>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "caged.h"
#include "support/all_tests.h"
#include "support/voxel_points.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

TEST_P(CagedTest, AtRestItIsThePartWithoutACage) {
  const Canvas canvas({160, 120});
  const fields::Occupancy volume = ballClump({60, 80, 50}, 20, 2);
  const LoadedAsset plain(packOf(volume));
  const auto plain_renderer = makeRenderer(*plain.asset, kRestSurface);
  const int levels = plain.asset->pack().parts()[0].levels;
  for (const int cell : {4, 8, 16}) {
    const LoadedAsset with(cagedPackOf(volume, cell));
    const auto renderer = makeRenderer(*with.asset, kRestSurface);
    Instance instance{plain.asset.get()};
    instance.to_world = glm::rotate(glm::mat4(1), 0.4f, glm::vec3(1, 2, 3)) *
                        glm::scale(glm::mat4(1), glm::vec3(-1, 1.2f, 0.8f));
    Instance same = instance;
    same.asset = with.asset.get();
    const glm::vec3 inside = voxelToWorld(instance, 0, 0.5f * glm::vec3(volume.size));
    const std::pair<const char*, gl::View> views[] = {
        {"outside", closeTo(canvas, instance)},
        {"from below", closeTo(canvas, instance, {-0.5f, -0.9f, 0.1f})},
        {"orthographic", orthographic(canvas, {3, 2, 4}, {0, 0.5f, 0}, 0.7f)},
        {"inside the bounds", lookAt(canvas, inside + glm::vec3(0.12f, 0.2f, 0.1f), inside, 0.01f)},
        {"inside the solid", lookAt(canvas, inside, inside + glm::vec3(1, 0.2f, 0.3f), 0.01f)},
        {"cut by the near plane", lookAt(canvas, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 1.4f)},
        {"cut by the far plane", lookAt(canvas, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 0.1f, 1.7f)},
    };
    for (const auto& [name, of] : views) {
      for (int level = 0; level < levels; ++level) {
        SCOPED_TRACE(testing::Message() << "cell " << cell << ", " << name << ", level " << level);
        gl::View view = of;
        view.quality.finest_level = level;
        const Difference difference = differenceOf(draw(*plain_renderer, view, instance, canvas),
                                                   draw(*renderer, view, same, canvas), canvas.size());
        EXPECT_GT(difference.covered, 300);
        EXPECT_LE(difference.outline, 4 + difference.covered / 400);
        EXPECT_LE(difference.apart, 2 + difference.covered / (level < 2 ? 1000 : 150));
      }
    }
  }
}

// Bent by the same splines: nodes follow the spline, or are where the host puts them.
TEST_P(CagedTest, ItsNodesBendItAsItsSplineDoes) {
  const Canvas canvas({320, 240});
  // A thick column with a hole.
  fields::Occupancy volume = ballClump({36, 96, 32}, 1, 3);
  for (int z = 2; z < 30; ++z)
    for (int y = 1; y < 95; ++y)
      for (int x = 1; x < 35; ++x)
        volume.solid[volume.index({x, y, z})] = x < 12 || x > 20 || y < 40 || y > 60;
  const auto sweeps = reference::namedSweeps(volume.size);
  std::vector<RawPack> packs;
  // (Where a sheared part ends level, as in Figure 6, it bends more sharply than any cell can.)
  for (const FigurePose& pose : {FigurePose{"", {1.5f, 1, 0.4f}, {-0.8f, 1, 0.6f}},
                                 FigurePose{"", {-0.7f, 0.8f, 2}, {1, 1.3f, -1.4f}}})
    packs.push_back(packOf(volume, figureKnots(pose)));
  for (const std::size_t named : {2u, 5u}) packs.push_back(sweptPackOf(volume, sweeps[named]));
  for (std::size_t i = 0; i < packs.size(); ++i) {
    SCOPED_TRACE(i);
    const LoadedAsset plain(packs[i]), with(caged(packs[i], 2));
    const auto plain_renderer = makeRenderer(*plain.asset, kRestSurface),
               renderer = makeRenderer(*with.asset, kRestSurface);
    const Instance instance{plain.asset.get()};
    const gl::View view = closeTo(canvas, instance);
    const std::vector<Pixel> expected = draw(*plain_renderer, view, instance, canvas);
    const std::vector<Pixel> by_spline = draw(*renderer, view, {with.asset.get()}, canvas);
    const Difference difference = differenceOf(expected, by_spline, canvas.size());
    EXPECT_GT(difference.covered, 2000);
    EXPECT_GT(difference.iou(), 0.99);
    EXPECT_LE(difference.apart, difference.covered / 100);

    runtime::Pose pose = *runtime::Pose::create(*with.asset);
    const Part& part = with.asset->pack().parts()[0];
    const std::span<glm::vec3> nodes = pose.nodes(0);
    ASSERT_EQ(nodes.size(), part.cages[0].nodes());
    const glm::mat4 to_part = glm::inverse(*runtime::partToWorld(instance, 0));
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      const glm::vec3 rest = part.to_object * glm::vec4(glm::vec3(part.cages[0].rest(n)), 1);
      nodes[n] = to_part * glm::vec4(*runtime::toWorld(instance, 0, rest), 1);
    }
    const Difference by_host =
        differenceOf(by_spline, draw(*renderer, view, {with.asset.get(), &pose}, canvas), canvas.size());
    EXPECT_LE(by_host.outline, 4);
    EXPECT_LE(by_host.apart, 2);
    // What the nodes do shows.
    for (glm::vec3& node : pose.nodes(0)) node.x += 8;
    EXPECT_GT(differenceOf(by_spline, draw(*renderer, view, {with.asset.get(), &pose}, canvas), canvas.size())
                  .outline,
              300);
  }
}

TEST_P(CagedTest, ThePassOfDepthsIsThatOfColors) {
  const Canvas canvas({160, 120});
  const LoadedAsset with(cagedPackOf(ballClump({36, 96, 32}, 40, 3), 8, figureKnots(kFigure6[2])));
  const auto renderer = makeRenderer(*with.asset);
  const Instance instance{with.asset.get()};
  for (const float near : {0.01f, 0.7f}) {
    gl::View view = closeTo(canvas, instance);
    view.camera.eye_to_clip = lookAt(canvas, {}, {0, 0, -1}, near).camera.eye_to_clip;
    const std::vector<Pixel> colors = draw(*renderer, view, instance, canvas);
    const std::vector<float> depths = desktop() ? canvas.depths() : std::vector<float>();
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, instance, gl::Pass::kDepth));
    if (desktop()) {
      EXPECT_EQ(canvas.depths(), depths);
    }
    EXPECT_EQ(canvas.pixels(), std::vector<Pixel>(colors.size()));
    ASSERT_TRUE(renderer->draw(view, instance));
    EXPECT_EQ(canvas.pixels(), colors);
  }
}

TEST_P(CagedTest, MotionIsThatOfThePartWithoutACage) {
  constexpr char kMotion[] =
      "vec4 kelpSurface(KelpSurface s) {\n"
      "  vec2 moved = s.clip.xy / s.clip.w - s.previous_clip.xy / s.previous_clip.w;\n"
      "  return vec4(0.5 + moved, 0.0, 1.0);\n"
      "}\n";
  const Canvas canvas({160, 120});
  const RawPack pack = packOf(ballClump({36, 96, 32}, 40, 3));
  const LoadedAsset plain(pack), with(caged(pack, 2));
  const auto plain_renderer = makeRenderer(*plain.asset, kMotion),
             renderer = makeRenderer(*with.asset, kMotion);
  const auto posed = [](const runtime::Asset& asset, std::size_t figure) {
    runtime::Pose pose = *runtime::Pose::create(asset);
    EXPECT_TRUE(pose.setKnots(0, figureKnots(kFigure6[figure])));
    return pose;
  };
  const runtime::Pose now = posed(*plain.asset, 1), then = posed(*plain.asset, 3);
  const runtime::Pose caged_now = posed(*with.asset, 1), caged_then = posed(*with.asset, 3);
  const glm::mat4 moved = glm::translate(glm::mat4(1), glm::vec3(0.1f, -0.05f, 0.02f));
  Instance instance{plain.asset.get(), &now}, same{with.asset.get(), &caged_now};
  gl::View view = closeTo(canvas, instance);
  const glm::mat4 before = view.camera.eye_to_clip * view.camera.world_to_eye *
                           glm::translate(glm::mat4(1), glm::vec3(0, 0, 0.1f));
  view.camera.previous_world_to_clip = &before;
  for (int turn = 0; turn < 3; ++turn) {
    SCOPED_TRACE(turn);
    if (turn > 0) instance.previous_pose = &then, same.previous_pose = &caged_then;
    if (turn > 1) instance.previous_to_world = same.previous_to_world = &moved;
    const Difference difference = differenceOf(draw(*plain_renderer, view, instance, canvas),
                                               draw(*renderer, view, same, canvas), canvas.size());
    EXPECT_GT(difference.covered, 1000);
    EXPECT_LE(difference.apart, difference.covered / 50);
    // Other motions are told from it.
    Instance other = same;
    other.previous_pose = turn > 0 ? nullptr : &caged_then;
    EXPECT_GT(differenceOf(draw(*plain_renderer, view, instance, canvas),
                           draw(*renderer, view, other, canvas), canvas.size())
                  .apart,
              300);
  }
}

TEST_P(CagedTest, RaysOfItsOwnMeetIt) {
  const Canvas canvas({120, 90});
  const fields::Occupancy volume = ballClump({60, 80, 50}, 20, 2);
  const LoadedAsset plain(packOf(volume)), with(cagedPackOf(volume, 4));
  constexpr char kShadow[] = "vec4 kelpSurface(KelpSurface s) { return vec4(kelpVisible(s), 0.0, 1.0); }\n";
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto plain_renderer = makeRenderer(*plain.asset, kShadow, config),
             renderer = makeRenderer(*with.asset, kShadow, config);
  const Instance instance{plain.asset.get()}, same{with.asset.get()};
  gl::View view = closeTo(canvas, instance);
  view.quality.self_shadow = true;
  view.quality.occlusion_rays = 2;
  const std::vector<Pixel> expected = draw(*plain_renderer, view, instance, canvas);
  const Difference difference = differenceOf(expected, draw(*renderer, view, same, canvas), canvas.size());
  EXPECT_GT(difference.covered, 1000);
  EXPECT_LE(difference.apart, difference.covered / 50);
  int dark = 0;
  for (const Pixel& pixel : expected) dark += pixel[3] != 0 && pixel[0] == 0;
  EXPECT_GT(dark, 100);
}

// True if a picture by kRestSurface shows there what a ray hits through that pixel, or 1/64 of a pixel
// beside.
bool showsItsHit(const Pixel& pixel, const gl::View& view, const Instance& instance, int x, int y) {
  const Part& part = instance.asset->pack().parts()[0];
  const glm::mat4 to_part = glm::inverse(glm::mat4(part.to_object));
  constexpr double kBeside = 1.0 / 32;
  for (const glm::dvec2& beside : {glm::dvec2(0), {-kBeside, 0}, {kBeside, 0}, {0, -kBeside}, {0, kBeside}}) {
    const auto hit = raycast(instance, pixelRay(view, x + beside.x, y + beside.y));
    if (!hit && pixel[3] == 0) return true;
    if (!hit || pixel[3] == 0) continue;
    const glm::vec3 rest = 255.0f * glm::vec3(to_part * glm::vec4(hit->rest, 1)) / glm::vec3(part.size);
    const glm::vec3 off = glm::abs(rest - glm::vec3(pixel[0], pixel[1], pixel[2]));
    if (std::max({off.x, off.y, off.z}) < 1.5f) return true;
  }
  return false;
}

// raycast() goes another way, through the tree, and on the CPU.
TEST_P(CagedTest, APixelShowsWhatItsRayHits) {
  const Canvas canvas(allTests() ? glm::ivec2(1280, 960) : glm::ivec2(320, 240));
  const LoadedAsset with(cagedPackOf(ballClump({90, 160, 80}, 30, 5), 8, figureKnots(kFigure6[2])));
  const auto renderer = makeRenderer(*with.asset, kRestSurface);
  const runtime::Pose bent = *runtime::Pose::create(*with.asset);
  runtime::Pose shaken = *runtime::Pose::create(*with.asset);
  std::mt19937 random(4);
  for (glm::vec3& node : shaken.nodes(0))
    for (int axis = 0; axis < 3; ++axis) node[axis] += 0.8f * (static_cast<float>(random()) * 0x1p-31f - 1);
  int covered = 0, apart = 0;
  for (const runtime::Pose* const pose : {&bent, &std::as_const(shaken)}) {
    const Instance instance{with.asset.get(), pose};
    for (const glm::vec3& from : {glm::vec3(0.5f, 0.3f, 0.8f), glm::vec3(-0.8f, 0.1f, -0.5f)}) {
      const gl::View view = closeTo(canvas, instance, from);
      const std::vector<Pixel> picture = draw(*renderer, view, instance, canvas);
      for (int i = 0; i < canvas.size().x * canvas.size().y; ++i) {
        const Pixel& pixel = picture[static_cast<std::size_t>(i)];
        covered += pixel[3] != 0;
        apart += !showsItsHit(pixel, view, instance, i % canvas.size().x, i / canvas.size().x);
      }
    }
  }
  RecordProperty("covered", covered);
  RecordProperty("apart", apart);
  EXPECT_GT(covered, canvas.size().x * canvas.size().y / 2);
  EXPECT_LE(apart, 4 * canvas.size().x * canvas.size().y / 100000);  // one ray in 100,000
}

KELP_GL_TESTS(CagedTest);

}  // namespace
}  // namespace kelp::test

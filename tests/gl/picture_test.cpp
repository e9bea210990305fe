// SPDX-License-Identifier: MIT
// The GPU's picture against runtime::raycast, pixel by pixel: the same voxel, the same depth.
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "support/voxel_knots.h"
#include "support/voxel_points.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

struct Agreement {
  int hits = 0;         // of the CPU
  int one_sided = 0;    // hit on one side, none on the other
  int other_voxel = 0;  // both hit, more than one voxel apart
  double worst_depth = 0;
};

class PictureTest : public GlTest {
 protected:
  // Draws with kVoxelSurface and compares with the nearest of the instances' hits.
  Agreement compare(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view,
                    std::span<const Instance> instances, int level = 0) {
    canvas.clear();
    const auto drawn = renderer.draw(view, instances);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    const std::vector<Pixel> pixels = canvas.pixels();
    const std::vector<float> depths = desktop() ? canvas.depths() : std::vector<float>();
    const glm::dmat4 to_clip = glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye);
    Agreement result;
    for (int y = 0; y < canvas.size().y; ++y) {
      for (int x = 0; x < canvas.size().x; ++x) {
        const auto i = static_cast<std::size_t>(y * canvas.size().x + x);
        const runtime::Ray ray = pixelRay(view, x, y);
        std::optional<runtime::Hit> hit;
        for (const Instance& instance : instances) {
          const auto other = raycast(instance, ray, level);
          if (other && (!hit || other->t < hit->t)) hit = other;
        }
        result.hits += hit.has_value();
        const bool drawn_here = pixels[i][3] != 0;
        if (drawn_here != hit.has_value()) {
          ++result.one_sided;
          continue;
        }
        if (!hit) continue;
        EXPECT_EQ(255 - pixels[i][3], hit->level);
        const glm::ivec3 voxel(pixels[i][0], pixels[i][1], pixels[i][2]);
        const glm::ivec3 apart = glm::abs(voxel - hit->voxel);
        if (std::max({apart.x, apart.y, apart.z}) > 1) {
          ++result.other_voxel;
          continue;
        }
        if (!depths.empty() && voxel == hit->voxel) {
          const glm::dvec4 clip =
              to_clip * glm::dvec4(glm::dvec3(ray.origin) + double{hit->t} * glm::dvec3(ray.direction), 1);
          result.worst_depth =
              std::max(result.worst_depth, std::abs(0.5 + 0.5 * clip.z / clip.w - double{depths[i]}));
        }
      }
    }
    return result;
  }

  void expectAgreement(const Agreement& result, const char* what) {
    SCOPED_TRACE(what);
    EXPECT_GT(result.hits, 150);
    // The two compute the pixel's ray in different ways and precision: rays that graze a voxel may differ.
    // (None does on llvmpipe.)
    EXPECT_LE(result.one_sided, 1 + result.hits / 500);
    EXPECT_LE(result.other_voxel, 1 + result.hits / 200);
    EXPECT_LE(result.worst_depth, 1e-4);
  }

  const fields::Occupancy volume_ = ballClump({60, 80, 50}, 20, 2);
  const LoadedAsset loaded_{packOf(volume_)};
  runtime::Pose pose_ = *runtime::Pose::create(*loaded_.asset);

  void take(const FigurePose& figure) {
    const std::vector<Knot> knots = figureKnots(figure);
    (void)pose_.setKnots(0, knots);
  }
};

TEST_P(PictureTest, AgreesWithTheCpuInEveryPoseOfFigure6) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  for (const FigurePose& figure : kFigure6) {
    take(figure);
    const Instance instance{loaded_.asset.get(), &pose_};
    const Box box = bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    const float reach = glm::distance(box.min, box.max);
    const gl::View view = lookAt(canvas, center + reach * glm::vec3(0.5f, 0.3f, 0.8f), center);
    expectAgreement(compare(*renderer, canvas, view, {&instance, 1}), figure.name);
  }
}

TEST_P(PictureTest, AgreesWithTheEyeInsideTheVolume) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  take(kFigure6[1]);
  const Instance instance{loaded_.asset.get(), &pose_};
  const glm::vec3 eye = voxelToWorld(instance, 0, {30, 62, 25});
  expectAgreement(
      compare(*renderer, canvas, lookAt(canvas, eye, eye + glm::vec3(1, -0.4f, 0.2f), 0.02f), {&instance, 1}),
      "inside");
  // A near plane that cuts through the solid.
  expectAgreement(
      compare(*renderer, canvas, lookAt(canvas, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 1.4f), {&instance, 1}),
      "near plane cuts");
  // A far plane that ends the picture inside the volume.
  expectAgreement(compare(*renderer, canvas, lookAt(canvas, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 0.1f, 1.7f),
                          {&instance, 1}),
                  "far plane cuts");
}

TEST_P(PictureTest, AgreesInOrthographicViews) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  take(kFigure6[2]);
  const Instance instance{loaded_.asset.get(), &pose_};
  expectAgreement(
      compare(*renderer, canvas, orthographic(canvas, {3, 2, 4}, {0, 0.5f, 0}, 0.7f), {&instance, 1}),
      "orthographic");
  // Half a height that puts no row of pixels exactly into a plane between voxels, where either side would be
  // right.
  expectAgreement(
      compare(*renderer, canvas, orthographic(canvas, {0, 0.5f, 4}, {0, 0.5f, 0}, 0.7123f), {&instance, 1}),
      "exactly horizontal");
  gl::View above = orthographic(canvas, {0, 0, 0}, {0, 0, -1}, 0.7f);
  above.camera.world_to_eye = glm::rotate(glm::mat4(1), glm::radians(90.0f), glm::vec3(1, 0, 0)) *
                              glm::translate(glm::mat4(1), glm::vec3(0, -5, 0));
  expectAgreement(compare(*renderer, canvas, above, {&instance, 1}), "along the spline");
}

TEST_P(PictureTest, AgreesWithTheCpuInEverySweptPose) {
  const Canvas canvas({160, 120});
  const fields::Occupancy column = ballClump({36, 128, 32}, 12, 3);
  for (const reference::SweepRig& rig : reference::namedSweeps(column.size)) {
    const LoadedAsset swept(sweptPackOf(column, rig));
    const auto renderer = makeRenderer(*swept.asset, kVoxelSurface);
    Instance instance{swept.asset.get()};
    instance.to_world = glm::rotate(glm::mat4(1), 0.4f, glm::vec3(1, 2, 3)) *
                        glm::scale(glm::mat4(1), glm::vec3(-1, 1.2f, 0.8f));
    const Box box = bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    const float reach = glm::distance(box.min, box.max);
    const gl::View view = lookAt(canvas, center + reach * glm::vec3(0.5f, 0.3f, 0.8f), center);
    expectAgreement(compare(*renderer, canvas, view, {&instance, 1}), rig.name.c_str());
    expectAgreement(
        compare(*renderer, canvas,
                orthographic(canvas, center + reach * glm::vec3(-1, 0.2f, 0.3f), center, 0.4f * reach),
                {&instance, 1}),
        rig.name.c_str());
    const glm::vec3 eye = voxelToWorld(instance, 0, {18, 64, 16}),
                    along = voxelToWorld(instance, 0, {20, 84, 15});
    expectAgreement(compare(*renderer, canvas, lookAt(canvas, eye, along, 0.01f), {&instance, 1}),
                    rig.name.c_str());
  }
}

TEST_P(PictureTest, ShearedAndSweptInstancesInOneCall) {
  const Canvas canvas({160, 120});
  const fields::Occupancy column = ballClump({36, 128, 32}, 12, 3);
  const LoadedAsset swept(sweptPackOf(column, 5));
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  ASSERT_TRUE(renderer->add(*swept.asset));
  ASSERT_TRUE(renderer->upload(~std::uint64_t{0}));
  take(kFigure6[1]);
  Instance instances[3] = {{swept.asset.get()}, {loaded_.asset.get(), &pose_}, {swept.asset.get()}};
  instances[0].to_world = glm::translate(glm::mat4(1), glm::vec3(-0.5f, 0.1f, 0.3f));
  instances[2].to_world = glm::translate(glm::mat4(1), glm::vec3(0.5f, 0.2f, -0.3f));
  const gl::View view = lookAt(canvas, {0.5f, 1.0f, 2.4f}, {0.1f, 0.5f, 0});
  const auto drawn = renderer->draw(view, instances);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->draws, 2u);
  EXPECT_EQ(drawn->instances, 3u);
  expectAgreement(compare(*renderer, canvas, view, instances), "of both kinds");
}

TEST_P(PictureTest, MirroredAndStretchedInstancesInOneDraw) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  take(kFigure6[1]);
  Instance instances[3] = {
      {loaded_.asset.get(), &pose_}, {loaded_.asset.get(), nullptr}, {loaded_.asset.get(), &pose_}};
  instances[0].to_world =
      glm::translate(glm::mat4(1), glm::vec3(-0.8f, 0, 0)) * glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1));
  instances[1].to_world = glm::rotate(glm::translate(glm::mat4(1), glm::vec3(0.3f, 0.2f, -0.5f)), 0.7f,
                                      glm::vec3(0.3f, 0.2f, 1)) *
                          glm::scale(glm::mat4(1), glm::vec3(0.6f, 1.4f, 0.9f));
  instances[2].to_world = glm::translate(glm::mat4(1), glm::vec3(1.1f, 0.1f, 0));
  const gl::View view = lookAt(canvas, {0.5f, 1.2f, 3.2f}, {0.1f, 0.5f, 0});
  const auto drawn = renderer->draw(view, instances);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->draws, 1u);
  EXPECT_EQ(drawn->instances, 3u);
  expectAgreement(compare(*renderer, canvas, view, instances), "three in one draw");
  // A picture that is upside down, as hosts draw for other APIs: the same voxels.
  gl::View flipped = view;
  flipped.camera.eye_to_clip = glm::scale(glm::mat4(1), glm::vec3(1, -1, 1)) * view.camera.eye_to_clip;
  expectAgreement(compare(*renderer, canvas, flipped, instances), "flipped projection");
}

TEST_P(PictureTest, PartsFollowTheirParents) {
  const Canvas canvas({160, 120});
  const fields::Occupancy arm = ballClump({20, 48, 24}, 14, 5);
  RawPack pack = packOf(volume_);
  pack.parts.push_back(partOf(arm, figureKnots(kFigure6[1]), "arm"));
  pack.parts[1].parent = 0;
  pack.parts[1].to_object[3] += glm::vec3(0.6f, 0.2f, 0);
  pack.parts[1].pivot[3] = glm::vec3(0.5f, 0.3f, 0);
  const LoadedAsset loaded(pack);
  runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
  pose.motion(0)->rotation = glm::angleAxis(0.5f, glm::normalize(glm::vec3(0.2f, 1, 0.1f)));
  pose.motion(1)->rotation = glm::angleAxis(-0.9f, glm::vec3(0, 0, 1));
  pose.motion(1)->scale = {0.8f, 1.2f, 1};
  pose.motion(1)->translation = {0.1f, 0.05f, 0.2f};
  const auto renderer = makeRenderer(*loaded.asset, kVoxelSurface);
  const Instance instance{loaded.asset.get(), &pose};
  const gl::View view = lookAt(canvas, {1.0f, 1.1f, 2.4f}, {0.2f, 0.5f, 0});
  expectAgreement(compare(*renderer, canvas, view, {&instance, 1}), "two parts");
  EXPECT_EQ(renderer->draw(view, {&instance, 1})->instances, 2u);

  pose.motion(1)->scale = glm::vec3(0);  // a part may vanish
  const auto drawn = renderer->draw(view, {&instance, 1});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->instances, 1u);
  EXPECT_EQ(drawn->culled, 1u);
}

// Normals, positions and materials that the surface function gets, against the CPU's.
TEST_P(PictureTest, SurfacesAreTheCpus) {
  const Canvas canvas({160, 120});
  const auto normals = makeRenderer(
      *loaded_.asset, "vec4 kelpSurface(KelpSurface s) { return vec4(0.5 + 0.5 * s.normal, 1.0); }\n");
  const auto rests = makeRenderer(*loaded_.asset,
                                  "vec4 kelpSurface(KelpSurface s) { return vec4(s.rest / s.size, 1.0); }\n");
  const auto colors =
      makeRenderer(*loaded_.asset, "vec4 kelpSurface(KelpSurface s) { return vec4(s.color.rgb, 1.0); }\n");
  take(kFigure6[3]);
  Instance instance{loaded_.asset.get(), &pose_};
  instance.tint = {1, 0.5f, 0.25f, 1};
  instance.to_world = glm::rotate(glm::mat4(1), 0.4f, glm::vec3(1, 2, 3)) *
                      glm::scale(glm::mat4(1), glm::vec3(-1, 1.5f, 0.7f));
  const gl::View view = lookAt(canvas, {0.8f, 1.5f, 3}, {0, 0.8f, 0});
  const auto drawnBy = [&](gl::Renderer& renderer) {
    canvas.clear();
    EXPECT_TRUE(renderer.draw(view, {&instance, 1}));
    return canvas.pixels();
  };
  const std::vector<Pixel> normal_pixels = drawnBy(*normals);
  const std::vector<Pixel> rest_pixels = drawnBy(*rests);
  const std::vector<Pixel> color_pixels = drawnBy(*colors);
  const auto expectNear = [](const Pixel& pixel, const glm::vec3& value, const char* what) {
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(static_cast<float>(pixel[static_cast<std::size_t>(i)]), 255 * value[i], 1.6f) << what;
  };
  int compared = 0;
  for (int y = 0; y < 120 && !HasFailure(); ++y) {
    for (int x = 0; x < 160; ++x) {
      const auto i = static_cast<std::size_t>(160 * y + x);
      const auto hit = raycast(instance, pixelRay(view, x, y));
      if (!hit || normal_pixels[i][3] == 0) continue;
      ++compared;
      expectNear(normal_pixels[i], 0.5f + 0.5f * hit->normal, "normal");
      expectNear(rest_pixels[i], restToVoxel(instance, 0, hit->rest) / glm::vec3(volume_.size), "rest");
      expectNear(color_pixels[i], glm::vec3(0.8f, 0.4f, 0.1f) * glm::vec3(instance.tint), "color");
    }
  }
  EXPECT_GT(compared, 500);
}

// Inner voxels, seen where the near plane cuts into a solid: the material beside them, and turned to the eye.
TEST_P(PictureTest, ACutSolidShowsTheMaterialBeside) {
  const Canvas canvas({80, 80});
  const fields::Occupancy block{{30, 30, 30}, std::vector<std::uint8_t>(27000, 1)};
  RawPack pack = packOf(block);
  pack.parts[0].levels = levelsOf(block, 1);
  const LoadedAsset loaded(pack);
  const auto renderer = makeRenderer(*loaded.asset,
                                     "vec4 kelpSurface(KelpSurface s) { return vec4(float(s.material), "
                                     "dot(s.normal, s.view), 0.0, 1.0); }\n");
  const Instance instance{loaded.asset.get(), nullptr};
  // cuts the block in the middle
  const gl::View view = orthographic(canvas, {0, 0.5f, 2}, {0, 0.5f, 0}, 0.6f, 2.0f, 5.0f);
  ASSERT_TRUE(renderer->draw(view, {&instance, 1}));
  const std::vector<Pixel> pixels = canvas.pixels();
  int beside = 0, within = 0;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      const auto hit = raycast(instance, pixelRay(view, x, y));
      const Pixel& pixel = pixels[static_cast<std::size_t>(80 * y + x)];
      ASSERT_EQ(hit.has_value(), pixel[3] != 0);
      if (!hit) continue;
      EXPECT_EQ(pixel[0] != 0, hit->material == 1);
      const int edge = std::min({hit->voxel.x, hit->voxel.y, 29 - hit->voxel.x, 29 - hit->voxel.y});
      beside += edge > 0 && edge <= 8;
      within += edge > 8;
      if (edge > 0) {
        EXPECT_EQ(pixel[0] != 0, edge <= 8);
        EXPECT_EQ(pixel[1], 255);
      }
    }
  }
  EXPECT_GT(beside, 1200);
  EXPECT_GT(within, 250);
}

// A sphere's light side is where the sun is.
TEST_P(PictureTest, TheSunLightsTheSideThatFacesIt) {
  const Canvas canvas({80, 80});
  fields::Occupancy ball{{40, 40, 40}, std::vector<std::uint8_t>(64000)};
  for (int i = 0; i < 64000; ++i) {
    ball.solid[static_cast<std::size_t>(i)] =
        glm::distance(glm::vec3(i % 40, i / 40 % 40, i / 1600) + 0.5f, glm::vec3(20)) < 19;
  }
  const LoadedAsset loaded(packOf(ball));
  const auto renderer = makeRenderer(*loaded.asset);
  const Instance instance{loaded.asset.get(), nullptr};
  for (const glm::vec3 sun :
       {glm::vec3(1, 0, 0.3f), glm::vec3(-1, 0, 0.3f), glm::vec3(0, 1, 0.3f), glm::vec3(0, -1, 0.3f)}) {
    gl::View view = lookAt(canvas, {0, 0.5f, 3}, {0, 0.5f, 0});
    view.light.sun_direction = 7.0f * sun;
    view.light.ground_color = view.light.sky_color = glm::vec3(0.1f);
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, {&instance, 1}));
    const std::vector<Pixel> pixels = canvas.pixels();
    glm::vec2 center(0);
    float sum = 0;
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 80; ++x) {
        const Pixel& pixel = pixels[static_cast<std::size_t>(80 * y + x)];
        center += static_cast<float>(pixel[0]) * (glm::vec2(x, y) - 39.5f);
        sum += static_cast<float>(pixel[0]);
      }
    }
    center /= sum;
    EXPECT_GT(glm::dot(center, glm::vec2(sun)), 3.0f);
    EXPECT_LT(std::abs(center.x * sun.y - center.y * sun.x), 1.0f);
  }
}

TEST_P(PictureTest, SeveralSegmentsAndAMovedEnd) {
  const Canvas canvas({160, 120});
  const std::vector<Knot> knots = inHeights({{0, {0, 0, 0}, {60, 50, 0}},
                                             {0.3f, {14, 30, 4}, {-30, 90, 40}},
                                             {0.6f, {-6, 50, 10}, {0, 60, -80}},
                                             {1, {0, 95, 0}, {40, 70, 30}}},
                                            static_cast<float>(volume_.size.y));
  const LoadedAsset loaded(packOf(volume_, knots));
  const auto renderer = makeRenderer(*loaded.asset, kVoxelSurface);
  const Instance instance{loaded.asset.get(), nullptr};
  expectAgreement(
      compare(*renderer, canvas, lookAt(canvas, {1.2f, 1.0f, 1.6f}, {0, 0.55f, 0}), {&instance, 1}),
      "three segments");
}

KELP_GL_TESTS(PictureTest);

}  // namespace
}  // namespace kelp::test

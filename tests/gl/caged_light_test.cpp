// SPDX-License-Identifier: MIT
// Shadows, occlusion and kelpDistance of parts with cages: against rays and distances in double precision.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "../runtime/caged_instance.h"
#include "caged.h"
#include "distance_probe.h"
#include "light_truth.h"

namespace kelp::test {
namespace {

// A plate, and another one above it, between which no cell is.
fields::Occupancy plates() {
  return voxelsWhere({112, 80, 96}, [](const glm::ivec3& v) {
    return v.y < 9 || (v.y >= 48 && v.y < 58 && v.x < 50 && v.z > 20);
  });
}

class CagedLight : public CagedTest {
 protected:
  static gl::RendererOptions with(gl::Features features) {
    gl::RendererOptions config;
    config.features = features;
    return config;
  }
  // Draws a pose of the nodes with hard shadows and eight rays, and by distances, and measures the errors.
  // errors.sun.rays: of the hard shadow.
  LightErrors lightOf(const CagedDistances& model, const reference::CagePose& in, const glm::vec3& sun,
                      int tries) {
    const auto rays = makeRenderer(*model, kVisible, with(gl::Features::kSecondaryRays)),
               distances = makeRenderer(*model, kVisible, with(gl::Features::kDistances));
    const Canvas canvas({120, 100});
    runtime::Pose pose = *runtime::Pose::create(*model);
    const auto truth = model.put(in, *model, pose);
    Instance instance{&*model, &pose};
    instance.to_world = glm::rotate(glm::scale(glm::mat4(1), glm::vec3(1.5f)), 0.7f, glm::vec3(0, 1, 0));
    gl::View view = closeTo(canvas, instance, {0.4f, 0.4f, 0.6f});
    view.light.sun_direction = sun;
    view.quality.occlusion_reach = kReach;
    view.quality.occlusion_rays = 8;
    view.quality.self_shadow = true;
    LightPictures pictures;
    pictures.rays = pictures.sun_rays = draw(*rays, view, instance, canvas);
    view.quality.occlusion = true;
    view.quality.soft_shadows = kSunDegrees;
    pictures.distances = draw(*distances, view, instance, canvas);
    const LightSurfaces surfaces(
        [&](const glm::dvec3& o, const glm::dvec3& r, double far) { return truth->firstHit(o, r, far); },
        instance, view, pictures.distances);
    return measureLight(surfaces, pictures, tries);
  }
};

TEST_P(CagedLight, RaysAndDistancesSeeWhatTrueRaysSee) {
  const glm::ivec3 size(96, 128, 80);
  const CagedDistances model(ballClump(size, 11, 4), 8);
  std::vector<reference::CagePose> poses = reference::namedCagePoses(size);
  double sky = 0, sky_shade = 0, sun_shade = 0;
  for (const reference::CagePose& in : {poses[0], poses[2], poses[5], reference::shakenPose(0.5)}) {
    SCOPED_TRACE(in.name);
    const LightErrors errors = lightOf(model, in, {-0.7f, 0.5f, 0.2f}, allTests() ? 5000 : shareOf(300));
    EXPECT_GT(errors.sun.count, 4);
    EXPECT_LT(errors.sun.rays, 0.02);
    EXPECT_LT(errors.sun.distances, 0.02);
    EXPECT_LT(errors.sky.rays, 0.08);
    EXPECT_LT(errors.sky.distances, 0.09);
    sun_shade += errors.sun.shade / 4;
    sky_shade += errors.sky.shade / 4;
    sky += errors.sky.distances / 4;
  }
  EXPECT_GT(sun_shade, 0.1);
  EXPECT_LT(sky, 0.5 * sky_shade);  // all of it without occlusion
}

// Out of the lower plate's cells, and into those of the upper one, which nodes lift and lean.
TEST_P(CagedLight, RaysLeaveTheCageAndEnterItAgain) {
  const CagedDistances model(plates(), 8);
  for (const float lift : {0.0f, 13.0f}) {
    const reference::CagePose in{"lifted", [lift](const glm::dvec3& p) {
                                   return p.y < 30 ? p : p + glm::dvec3(0.2 * p.z, lift + 0.1 * p.x, 0);
                                 }};
    const LightErrors errors = lightOf(model, in, {-0.6f, 0.7f, 0.1f}, allTests() ? 5000 : shareOf(900));
    EXPECT_GT(errors.sun.shade, 0.08) << lift;
    EXPECT_LT(errors.sun.rays, 0.02) << lift;
    EXPECT_LT(errors.sun.distances, 0.02) << lift;
    EXPECT_LT(errors.sky.rays, 0.6 * errors.sky.shade) << lift;
    EXPECT_LT(errors.sky.distances, 0.6 * errors.sky.shade) << lift;
  }
}

// A plate in one part, and the one above it in another: with cages, as without.
TEST_P(CagedLight, PartsOfAnInstanceShadeEachOther) {
  const fields::Occupancy both = plates();
  RawPack pack = distancePackOf(both);
  const auto half = [&](bool upper, const char* name) {
    fields::Occupancy volume = both;
    for (int i = 0; i < both.size.x * both.size.y * both.size.z; ++i)
      if ((i / both.size.x % both.size.y >= 30) != upper) volume.solid[static_cast<std::size_t>(i)] = 0;
    RawPart part = distancePackOf(volume).parts[0];
    part.name = name;
    return part;
  };
  pack.parts = {half(false, "lower"), half(true, "upper")};
  const std::vector<std::byte> plain_bytes = bytesOf(pack), caged_bytes = bytesOf(caged(pack, 8));
  const MemorySource plain_source(plain_bytes), caged_source(caged_bytes);
  const auto plain = loadDistances(plain_source), with_cages = loadDistances(caged_source);
  const Canvas canvas({120, 100});
  gl::View view = closeTo(canvas, {plain.get()}, {0.4f, 0.4f, 0.6f});
  view.light.sun_direction = {-0.6f, 0.7f, 0.1f};
  view.quality.occlusion_reach = kReach;
  view.quality.occlusion = true;
  view.quality.soft_shadows = kSunDegrees;
  const auto pictureOf = [&](const runtime::Asset& asset) {
    canvas.clear();
    EXPECT_TRUE(makeRenderer(asset, kVisible, with(gl::Features::kDistances))->draw(view, Instance{&asset}));
    return canvas.pixels();
  };
  const std::vector<Pixel> expected = pictureOf(*plain), found = pictureOf(*with_cages);
  int covered = 0, dark = 0, dim = 0, apart = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    covered += expected[i][3] != 0;
    dark += expected[i][3] != 0 && expected[i][0] == 0;
    dim += expected[i][3] != 0 && expected[i][1] < 220;
    apart += std::abs(expected[i][0] - found[i][0]) > 40 || std::abs(expected[i][1] - found[i][1]) > 40;
  }
  EXPECT_GT(dark, 300);
  EXPECT_GT(dim, 300);
  EXPECT_LT(apart, covered / 100);
}

// At points of planes through and beside it. A block has a middle without cells.
TEST_P(CagedLight, KelpDistanceIsThatToTheVoxels) {
  const glm::ivec3 size(48, 64, 40);
  const fields::Occupancy clump = ballClump(size, 8, 4),
                          block = voxelsWhere(size, [](const glm::ivec3&) { return true; });
  const struct {
    const fields::Occupancy& volume;
    int cell;
  } kModels[] = {{clump, 4}, {clump, 8}, {block, 4}};
  std::vector<reference::CagePose> poses = reference::namedCagePoses(size);
  for (const auto& [volume, cell] : kModels) {
    const CagedDistances model(volume, cell);
    const auto renderer = makeRenderer(*model, nullptr, with(gl::Features::kDistances));
    const GLuint program = distanceProgram(GetParam(), *renderer);
    ASSERT_NE(program, 0u);
    const Canvas canvas({64, 64});
    for (const reference::CagePose& in :
         {poses[0], poses[2], poses[4], poses[5], reference::shakenPose(0.5)}) {
      SCOPED_TRACE(testing::Message() << in.name << ", cells of " << cell);
      runtime::Pose pose = *runtime::Pose::create(*model);
      const auto truth = model.put(in, *model, pose);
      Instance instance{&*model, &pose};
      instance.to_world = glm::rotate(glm::mat4(1), 0.6f, glm::vec3(0.2f, 1, 0.1f));
      const DistanceErrors errors = measureDistances(*renderer, program, canvas, instance, *truth);
      EXPECT_GT(errors.inside, 3);
      EXPECT_GT(errors.near, 30);
      EXPECT_LT(errors.most_inside, 0.9);
      EXPECT_LT(errors.worst, in.name == "rest" ? 1 : 2.5);
      EXPECT_GT(errors.share(0.02), in.name == "rest" ? 0.5 : 0.4);
      EXPECT_GT(errors.share(0.5), 0.8);
      EXPECT_LT(errors.share(0.98), 1.2);
    }
    glDeleteProgram(program);
  }
}

KELP_GL_TESTS(CagedLight);

}  // namespace
}  // namespace kelp::test

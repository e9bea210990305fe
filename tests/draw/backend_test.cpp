// SPDX-License-Identifier: MIT
// Draw data is enough: a backend that knows nothing else draws the pictures that the GL renderer draws.
#include <glm/gtc/matrix_transform.hpp>

#include "support/cage_pack.h"
#include "support/distance_pack.h"
#include "swept_pack.h"
#include "two_hosts.h"

namespace kelp::test {
namespace {

constexpr glm::ivec2 kSize(96, 72);

class BackendTest : public testing::Test {
 protected:
  void SetUp() override {
    context_.emplace(GlApi::kDesktop33);
    if (!*context_) GTEST_SKIP() << "no EGL device gives such a context: install libegl1 libgl1-mesa-dri";
  }

  runtime::Pose posed(const FigurePose& figure) const {
    runtime::Pose pose = *runtime::Pose::create(*clump_.asset);
    const std::vector<Knot> knots = figureKnots(figure);
    (void)pose.setKnots(0, knots);
    return pose;
  }
  // Close enough that voxels cover several pixels.
  static gl::View closeTo(const Instance& instance, const glm::vec3& from = {0.5f, 0.3f, 0.8f}) {
    const Box box = bounds(instance);
    const glm::vec3 middle = 0.5f * (box.min + box.max);
    return lookAt(kSize, middle + 0.6f * glm::distance(box.min, box.max) * from, middle);
  }

  std::optional<EglContext> context_;
  const LoadedAsset clump_{packOf(ballClump({30, 40, 26}, 12, 2))};
};

TEST_F(BackendTest, ShearedParts) {
  TwoHosts hosts(kSize);
  hosts.add(*clump_.asset);
  hosts.uploadAll();
  for (const FigurePose& figure : std::span(kFigure6).first(4)) {
    const runtime::Pose pose = posed(figure);
    const Instance instance{clump_.asset.get(), &pose};
    gl::View view = closeTo(instance);
    hosts.expectSame(figure.name, view, instance);
    view.output = gl::Output::kDisplay;
    view.quality.shading = gl::Shading::kFaces;
    hosts.expectSame("faces, for the screen", view, instance);
    view.quality.shading = gl::Shading::kSmooth;
    hosts.expectSame("smooth", view, instance);
    view.quality.finest_level = 1;
    hosts.expectSame("coarse", view, instance);
    view.quality = {.pixels_per_voxel = 7};
    hosts.expectSame("two levels in a pattern", view, instance);
  }
}

TEST_F(BackendTest, CamerasOfAllKinds) {
  TwoHosts hosts(kSize);
  hosts.add(*clump_.asset);
  hosts.uploadAll();
  const runtime::Pose pose = posed(kFigure6[1]);
  const Instance instance{clump_.asset.get(), &pose};
  const glm::vec3 inside = runtime::toWorld(instance, 0, {0.03f, 0.75f, 0}).value();
  hosts.expectSame("inside", lookAt(kSize, inside, inside + glm::vec3(1, -0.4f, 0.2f), 0.02f), instance);
  hosts.expectSame("the near plane cuts", lookAt(kSize, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 1.4f), instance);
  hosts.expectSame("the far plane cuts", lookAt(kSize, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 0.1f, 1.7f),
                   instance);
  hosts.expectSame("orthographic", orthographic(kSize, {3, 2, 4}, {0, 0.5f, 0}, 0.7f), instance);
  gl::View view = closeTo(instance);
  view.camera.eye_to_clip = glm::scale(glm::mat4(1), glm::vec3(1, -1, 1)) * view.camera.eye_to_clip;
  hosts.expectSame("upside down", view, instance);
}

TEST_F(BackendTest, SweptParts) {
  const fields::Occupancy column = ballClump({18, 64, 16}, 12, 3);
  TwoHosts hosts(kSize);
  for (const reference::SweepRig& rig : reference::namedSweeps(column.size)) {
    const LoadedAsset swept(sweptPackOf(column, rig));
    hosts.add(*swept.asset);
    hosts.uploadAll();
    Instance instance{swept.asset.get()};
    instance.to_world = glm::rotate(glm::mat4(1), 0.4f, glm::vec3(1, 2, 3)) *
                        glm::scale(glm::mat4(1), glm::vec3(-1, 1.2f, 0.8f));
    gl::View view = closeTo(instance);
    hosts.expectSame(rig.name.c_str(), view, instance);
    view.quality.finest_level = 1;
    view.quality.shading = gl::Shading::kSmooth;
    hosts.expectSame(rig.name.c_str(), view, instance);
    hosts.planner().remove(*swept.asset);
    hosts.renderer().remove(*swept.asset);
  }
}

TEST_F(BackendTest, PartsWithCages) {
  const fields::Occupancy column = ballClump({18, 64, 16}, 12, 3);
  for (const draw::Features features : {draw::Features::kNone, draw::Features::kSecondaryRays}) {
    TwoHosts hosts(kSize, features);
    const LoadedAsset swept(caged(sweptPackOf(column, 5), 4)),
        clump(cagedPackOf(ballClump({30, 40, 26}, 12, 2), 8));
    for (const LoadedAsset* loaded : {&swept, &clump}) hosts.add(*loaded->asset);
    hosts.uploadAll();
    Instance instance{swept.asset.get()};
    instance.to_world = glm::rotate(glm::mat4(1), 0.4f, glm::vec3(1, 2, 3)) *
                        glm::scale(glm::mat4(1), glm::vec3(-1, 1.2f, 0.8f));
    gl::View view = closeTo(instance);
    view.quality.self_shadow = features != draw::Features::kNone;
    const PassOptions options{.rays_may_flip = view.quality.self_shadow};
    hosts.expectSame("faces of the cage", view, instance, options);
    view.quality.shading = gl::Shading::kSmooth;
    hosts.expectSame("smooth", view, instance, options);
    view.quality = {.pixels_per_voxel = 5, .self_shadow = view.quality.self_shadow};
    const Instance at_rest{clump.asset.get()};
    hosts.expectSame("coarse", view, instance, options);
    view = closeTo(at_rest);
    const glm::vec3 inside = runtime::toWorld(at_rest, 0, {0.03f, 0.75f, 0}).value();
    hosts.expectSame("inside", lookAt(kSize, inside, inside + glm::vec3(1, -0.4f, 0.2f), 0.02f), at_rest);
    hosts.expectSame("the near plane cuts", lookAt(kSize, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 1.4f), at_rest);
    const Instance both[] = {instance, at_rest};
    view.quality.depth_batches = 2;
    hosts.expectSame("both", view, both);
  }
}

// Two parts, the second on the first, and a swept asset: each instance with a place, a tint, a palette.
class ManyInstances : public BackendTest {
 protected:
  static RawPack twoParts() {
    RawPack pack = packOf(ballClump({30, 40, 26}, 12, 2));
    pack.parts.push_back(partOf(ballClump({20, 48, 24}, 14, 5), figureKnots(kFigure6[1]), "arm"));
    pack.parts[1].parent = 0;
    pack.parts[1].to_object[3] += glm::vec3(0.6f, 0.2f, 0);
    pack.parts[1].pivot[3] = glm::vec3(0.5f, 0.3f, 0);
    pack.palette[0].emissive = {0.02f, 0.1f, 0};
    return pack;
  }
  ManyInstances() {
    pose_.motion(1)->rotation = glm::angleAxis(-0.9f, glm::vec3(0, 0, 1));
    std::fill(palette_.begin(), palette_.end(), Material{{0.2f, 0.3f, 0.9f, 1}, {0, 0, 0.1f}, 1, 0.3f});
    for (int i = 0; i < 9; ++i) {
      Instance instance{i % 3 == 2 ? swept_.asset.get() : two_.asset.get(), i % 3 == 1 ? &pose_ : nullptr};
      const float x = 0.55f * static_cast<float>(i % 4) - 0.8f, z = 0.5f * static_cast<float>(i / 4) - 1;
      instance.to_world = glm::rotate(glm::translate(glm::mat4(1), glm::vec3(x, 0.1f * x, z)), 1.0f * z,
                                      glm::vec3(0.1f, 1, 0.2f)) *
                          glm::scale(glm::mat4(1), glm::vec3(i % 2 ? -0.7f : 0.7f, 0.9f, 0.8f));
      instance.tint = glm::vec4(1, 1 - 0.1f * static_cast<float>(i), 0.8f, 1);
      if (i % 4 == 3) instance.palette = palette_;
      instances_.push_back(instance);
    }
  }
  void addAll(TwoHosts& hosts) const {
    hosts.add(*two_.asset);
    hosts.add(*swept_.asset);
    hosts.uploadAll();
  }

  const LoadedAsset two_{twoParts()};
  const LoadedAsset swept_{sweptPackOf(ballClump({18, 64, 16}, 12, 3), 5)};
  runtime::Pose pose_ = *runtime::Pose::create(*two_.asset);
  std::vector<Material> palette_ = std::vector<Material>(2);
  std::vector<Instance> instances_;
  const gl::View view_ = lookAt(kSize, {0.6f, 1.1f, 2.2f}, {0, 0.4f, 0});
};

TEST_F(ManyInstances, InOneCall) {
  TwoHosts hosts(kSize);
  addAll(hosts);
  hosts.expectSame("nine", view_, instances_);
  gl::View view = view_;
  view.quality.depth_batches = 8;
  hosts.expectSame("by the depth so far", view, instances_);
}

TEST_F(ManyInstances, InPasses) {
  TwoHosts hosts(kSize);
  addAll(hosts);
  for (const bool reversed : {false, true}) {
    gl::View view = view_;
    if (reversed) {  // the near plane at 1, the far plane at 0
      view.camera.eye_to_clip =
          glm::scale(glm::translate(glm::mat4(1), glm::vec3(0, 0, 0.5f)), glm::vec3(1, 1, -0.5f)) *
          view.camera.eye_to_clip;
      view.camera.clip_range = gl::ClipRange::kZeroToOne;
      view.camera.reversed_depth = true;
    }
    hosts.expectSame("depth", view, instances_, {.pass = draw::Pass::kDepth});
    hosts.expectSame("color after depth", view, instances_, {.clears = false});
    view.quality.depth_batches = 5;
    hosts.expectSame("batches", view, instances_);
    view.quality.depth_batches = 1;
    // A scene that is a slope from left to right.
    std::vector<float> given;
    for (int i = 0; i < kSize.x * kSize.y; ++i) {
      const float w = 1.2f + 2.5f * static_cast<float>(i % kSize.x) / static_cast<float>(kSize.x);
      const glm::vec4 clip = view.camera.eye_to_clip * glm::vec4(0, 0, -w, 1);
      given.push_back(reversed ? clip.z / clip.w : 0.5f + 0.5f * clip.z / clip.w);
    }
    hosts.expectSame("before what is given", view, instances_, {.given = given});
  }
}

TEST_F(ManyInstances, ShadowsAndOcclusion) {
  TwoHosts hosts(kSize, draw::Features::kSecondaryRays);
  addAll(hosts);
  gl::View view = view_;
  view.quality.self_shadow = true;
  view.quality.occlusion_rays = 6;
  hosts.expectSame("rays", view, instances_, {.rays_may_flip = true});
}

TEST_F(BackendTest, ShadowsAndOcclusionByDistances) {
  const fields::Occupancy volumes[] = {ballClump({30, 40, 26}, 12, 2), ballClump({20, 48, 24}, 14, 5)};
  RawPack pack = packOf(volumes[0]);
  pack.parts.push_back(partOf(volumes[1], figureKnots(kFigure6[1]), "arm"));
  pack.parts[1].to_object[3] += glm::vec3(0.3f, 0.2f, 0.4f);
  for (std::size_t i = 0; i < 2; ++i)
    pack.parts[i].distances = distancesOf(volumes[i], static_cast<int>(pack.parts[i].levels.size()));
  runtime::AssetOptions options;
  options.distance_level = 0;
  const LoadedAsset loaded(pack, options);
  ASSERT_TRUE(loaded.asset->loadsDistances());
  TwoHosts hosts(kSize, draw::Features::kDistances);
  hosts.add(*loaded.asset);
  hosts.uploadAll();
  const Instance instances[] = {{loaded.asset.get()}};
  gl::View view = closeTo(instances[0]);
  view.quality.soft_shadows = 4;
  view.quality.occlusion = true;
  const glm::mat4 before = view.camera.eye_to_clip * view.camera.world_to_eye;
  for (const glm::mat4* previous : {static_cast<const glm::mat4*>(nullptr), &before}) {
    view.camera.previous_world_to_clip = previous;  // records are longer
    hosts.expectSame("distances", view, instances, {.rays_may_flip = true});
  }
}

TEST_F(BackendTest, Fog) {
  const fields::Occupancy column = ballClump({18, 64, 16}, 12, 3);
  const auto rigs = reference::namedSweeps({24, 64, 20});
  TwoHosts hosts(kSize, draw::Features::kSecondaryRays);
  hosts.add(*clump_.asset);
  for (const bool swept : {false, true}) {
    for (const bool heat : {false, true}) {
      SCOPED_TRACE(testing::Message() << (swept ? "swept" : "sheared") << (heat ? ", hot" : ""));
      const glm::ivec3 size = swept ? glm::ivec3(24, 64, 20) : glm::ivec3(40, 56, 36);
      RawPack pack =
          fogPack(fogOf(size, puffs,
                        heat ? FogShape([](const glm::dvec3& p) { return puffs(p) * p.y; }) : FogShape()),
                  0.15f, swept ? rigs[5].knots : figureKnots(kFigure6[2]));
      if (swept) pack.parts[0].bend = Bend::kSweep, pack.parts[0].roll = rigs[5].roll;
      const LoadedAsset fog(pack);
      hosts.add(*fog.asset);
      hosts.uploadAll();
      Instance both[2] = {{fog.asset.get()}, {clump_.asset.get()}};
      gl::View view = closeTo(both[0]);
      hosts.expectSame("alone", view, both, {.pass = draw::Pass::kFog});
      view.quality.self_shadow = true;
      hosts.expectSame("shaded", view, both, {.pass = draw::Pass::kFog});
      view.quality = {.finest_level = 1, .pixels_per_voxel = 0};
      hosts.expectSame("coarse", view, both, {.pass = draw::Pass::kFog});
      view.quality = {.pixels_per_voxel = 4};
      both[1].to_world = glm::translate(glm::mat4(1), glm::vec3(0.2f, 0, 0.1f));
      hosts.expectSame("solids", view, both);
      hosts.expectSame("over solids", view, both, {.pass = draw::Pass::kFog, .clears = false});
      const std::vector<float> given(static_cast<std::size_t>(kSize.x * kSize.y), 0.9935f);
      hosts.expectSame("before what is given", view, both, {.pass = draw::Pass::kFog, .given = given});
      hosts.planner().remove(*fog.asset);
      hosts.renderer().remove(*fog.asset);
    }
  }
}

// Some KiB a frame, from the first voxel to the last.
TEST_F(BackendTest, Streaming) {
  RawPack pack = packOf(ballClump({60, 80, 50}, 20, 2));
  const std::vector<std::byte> bytes = bytesOf(pack);
  MemorySource source(bytes);
  const auto asset = runtime::Asset::open(source.source()).value();
  TwoHosts hosts(kSize);
  hosts.add(*asset);
  const Instance instance{asset.get()};
  gl::View view = closeTo(instance);
  view.quality.pixels_per_voxel = 1;
  int differ = 0, frame = 0;
  std::vector<glm::vec4> before;
  for (bool more = true; more; ++frame) {
    ASSERT_LT(frame, 500);
    const bool loaded = asset->pump().value();
    const draw::Stats sent = hosts.upload(8192);
    more = loaded || sent.pending > 0;
    if (sent.bytes_uploaded == 0 && more) continue;
    const Difference difference = hosts.draw(view, instance);
    EXPECT_EQ(difference.apart_inside, 0) << frame;
    EXPECT_LE(difference.apart, 1 + difference.shown / 500);
    differ += hosts.picture().colors != before;
    before = hosts.picture().colors;
  }
  EXPECT_GT(differ, 5);
  EXPECT_GT(hosts.draw(view, instance).shown, 1000);
}

}  // namespace
}  // namespace kelp::test

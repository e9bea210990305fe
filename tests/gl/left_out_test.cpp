// SPDX-License-Identifier: MIT
// An instance with a bad pose is left out, and no other. Palettes of instances, parts on
// splines, output for the screen.
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "support/edit_knots.h"
#include "support/fog_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;
using runtime::Pose;

class LeftOutTest : public GlTest {
 protected:
  static inline std::vector<std::string> said;
  static gl::RendererOptions logged() {
    said.clear();
    gl::RendererOptions config;
    config.log = [](void*, const char* text) { said.push_back(text); };
    return config;
  }
  // Two parts: an instance with a good and a bad one is left out as a whole.
  static RawPack twoParts() {
    RawPack pack = packOf(ballClump({24, 32, 20}, 12, 3));
    pack.parts.push_back(partOf(ballClump({16, 20, 16}, 5, 2), pack.parts[0].knots, "second"));
    pack.parts[1].to_object[3] += glm::vec3(0.8f, 0, 0);
    return pack;
  }
  // Of any mixture of good and bad ones, with an asset of two parts of 32 and 20 voxels' height.
  void expectTheOthers(const LoadedAsset& loaded);
};

// Any number of bad ones among many, at any place of the blocks that are computed together.
void LeftOutTest::expectTheOthers(const LoadedAsset& loaded) {
  const Canvas canvas({96, 64});
  const auto renderer = makeRenderer(*loaded.asset, nullptr, logged());
  const gl::View view = lookAt(canvas, {4, 5, 14}, {4, 1, 0});
  std::mt19937 random(4);
  for (const int bad : {1, 3, 17, 40, 70}) {
    SCOPED_TRACE(bad);
    constexpr int kCount = 70;
    std::vector<Pose> poses;
    std::vector<Instance> all, good;
    std::vector<std::size_t> order(kCount);
    for (std::size_t i = 0; i < kCount; ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    std::vector<bool> is_bad(kCount);
    for (int i = 0; i < bad; ++i) is_bad[order[static_cast<std::size_t>(i)]] = true;
    for (std::size_t i = 0; i < kCount; ++i) {
      poses.push_back(Pose::create(*loaded.asset).value());
      ASSERT_TRUE(poses[i].move(0, 1, {0.02f * static_cast<float>(i % 5), 0, 0}));
    }
    std::size_t first = kCount;
    for (std::size_t i = 0; i < kCount; ++i) {
      Instance instance{loaded.asset.get(), &poses[i]};
      instance.to_world[3] = glm::vec4(static_cast<float>(i % 10), static_cast<float>(i / 10), 0, 1);
      if (!is_bad[i]) good.push_back(instance);
      if (is_bad[i]) {
        first = std::min(first, i);
        switch (i % 4) {
          case 0:  // turns back; swept, folds
            ASSERT_TRUE(poses[i].move(1, 1, {0, -2, 0}));
            break;
          case 1:
            ASSERT_TRUE(poses[i].move(0, 0, {0, std::nanf(""), 0}));
            break;
          case 2:
            poses[i].motion(1)->translation.x = std::numeric_limits<float>::infinity();
            break;
          default:
            instance.to_world[2] = glm::vec4(0);
        }
      }
      all.push_back(instance);
    }
    canvas.clear();
    const auto drawn = renderer->draw(view, all);
    ASSERT_TRUE(drawn) << drawn.error().detail;
    const std::vector<Pixel> got = canvas.pixels();
    EXPECT_EQ(drawn->left_out, static_cast<std::uint32_t>(bad));
    EXPECT_EQ(drawn->first_left_out.offset, first);
    canvas.clear();
    const auto truth = renderer->draw(view, good);
    ASSERT_TRUE(truth);
    EXPECT_EQ(drawn->instances, truth->instances);
    EXPECT_EQ(got, canvas.pixels());
    EXPECT_EQ(truth->left_out, 0u);
  }
  ASSERT_EQ(said.size(), 1u) << "it is told once";
  EXPECT_NE(said[0].find("is left out: "), std::string::npos) << said[0];
}

TEST_P(LeftOutTest, TheOthersAreDrawnAsIfItWereNotThere) { expectTheOthers(LoadedAsset(twoParts())); }

TEST_P(LeftOutTest, TheOthersAreDrawnIfItsPartsAreSwept) {
  RawPack pack = twoParts();
  for (RawPart& part : pack.parts) part.bend = Bend::kSweep;
  expectTheOthers(LoadedAsset(pack));
  pack.parts[0].bend = Bend::kShear;
  expectTheOthers(LoadedAsset(pack));
}

// Parts of solid and of fog are drawn in passes of their own; the whole instance is left out of both.
TEST_P(LeftOutTest, ABadPartLeavesOutThePartsOfTheOtherKind) {
  const Canvas canvas({48, 48});
  RawPack pack = packOf(ballClump({24, 32, 20}, 12, 3));
  pack.parts.push_back(fogPack(fogOf({16, 16, 16}, [](const glm::dvec3&) { return 1.0; }), 0.2f).parts[0]);
  pack.parts[1].name = "fog";
  const LoadedAsset loaded(pack);
  const auto renderer = makeRenderer(*loaded.asset, nullptr, logged());
  const gl::View view = lookAt(canvas, {0, 0.6f, 4}, {0, 0.5f, 0});
  // The knots of either part, the motion of either part.
  for (const int bad : {-1, 0, 1, 2, 3}) {
    SCOPED_TRACE(bad);
    Pose pose = Pose::create(*loaded.asset).value();
    if (bad >= 2) {
      pose.motion(bad - 2)->translation.x = std::nanf("");
    } else if (bad >= 0) {
      ASSERT_TRUE(pose.move(bad, 1, {0, -2, 0}));
    }
    const Instance instance{loaded.asset.get(), &pose};
    for (const gl::Pass pass : {gl::Pass::kColor, gl::Pass::kFog}) {
      canvas.clear();
      const auto drawn = renderer->draw(view, {&instance, 1}, pass);
      ASSERT_TRUE(drawn) << drawn.error().detail;
      EXPECT_EQ(drawn->left_out, bad < 0 ? 0u : 1u);
      EXPECT_EQ(drawn->instances, bad < 0 ? 1u : 0u);
    }
  }
}

TEST_P(LeftOutTest, InstancesHaveColorsOfTheirOwn) {
  const Canvas canvas({90, 60});
  const LoadedAsset loaded(packOf(ballClump({24, 32, 20}, 12, 3)));
  const auto renderer = makeRenderer(
      *loaded.asset, "vec4 kelpSurface(KelpSurface s) { return vec4(s.color.rgb + s.emissive, 1.0); }\n");
  const gl::View view = lookAt(canvas, {0, 0.6f, 4}, {0, 0.5f, 0});
  const auto entries = loaded.asset->pack().palette().size();
  std::vector<Instance> instances(3);
  std::vector<std::vector<Material>> palettes;
  const glm::vec4 colors[] = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    Material material;
    material.base_color = colors[i];
    if (i == 2) material.emissive = {0, 0, 1};
    palettes.emplace_back(entries, material);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    instances[i].asset = loaded.asset.get();
    instances[i].to_world[3].x = static_cast<float>(i) - 1;
    instances[i].palette = palettes[i];
  }
  canvas.clear();
  ASSERT_TRUE(renderer->draw(view, instances));
  const std::vector<Pixel> pixels = canvas.pixels();
  int counts[3] = {};
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 90; ++x) {
      const Pixel& pixel = pixels[static_cast<std::size_t>(90 * y + x)];
      if (pixel[3] == 0) continue;
      const auto hit = runtime::raycast(instances, pixelRay(view, x, y));
      ASSERT_TRUE(hit) << x << " " << y;
      const Pixel wanted = {std::uint8_t(hit->instance == 0 ? 255 : 0),
                            std::uint8_t(hit->instance == 1 ? 255 : 0),
                            std::uint8_t(hit->instance == 2 ? 255 : 0), 255};
      ASSERT_EQ(pixel, wanted) << x << " " << y;
      ++counts[hit->instance];
    }
  }
  for (const int count : counts) EXPECT_GT(count, 40);
  // The pack's own colors come back.
  for (Instance& instance : instances) instance.palette = {};
  canvas.clear();
  ASSERT_TRUE(renderer->draw(view, instances));
  EXPECT_NE(canvas.pixels(), pixels);
}

// A leaf that hangs on a spline is drawn where the processor's rays meet it.
TEST_P(LeftOutTest, PartsOnSplinesAreDrawnWhereRaysMeetThem) {
  const Canvas canvas({80, 80});
  RawPack pack = twoParts();
  pack.parts[1].parent = 0;
  pack.parts[1].parent_at = 0.8f;
  const LoadedAsset loaded(pack);
  const auto renderer = makeRenderer(*loaded.asset, kVoxelSurface);
  Pose pose = Pose::create(*loaded.asset).value();
  ASSERT_TRUE(pose.move(0, 1, {0.6f, -0.1f, 0.2f}));
  const Instance instance{loaded.asset.get(), &pose};
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 4}, {0.8f, 0.5f, 0});
  canvas.clear();
  ASSERT_TRUE(renderer->draw(view, {&instance, 1}));
  const std::vector<Pixel> pixels = canvas.pixels();
  int leaf = 0, different = 0, hits = 0;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      const auto hit = runtime::raycast(instance, pixelRay(view, x, y));
      const Pixel& pixel = pixels[static_cast<std::size_t>(80 * y + x)];
      hits += hit.has_value();
      leaf += hit && hit->part == 1;
      different += hit.has_value() != (pixel[3] != 0) ||
                   (hit && glm::ivec3(pixel[0], pixel[1], pixel[2]) != hit->voxel);
    }
  }
  EXPECT_GT(leaf, 60);
  EXPECT_LE(different, 1 + hits / 200);
}

// sRGB by its standard, in double precision; dark and middle tones keep their light, bright ones do not clip.
TEST_P(LeftOutTest, TheOutputForTheScreenIsEncodedAndToneMapped) {
  const Canvas canvas({40, 40});
  const LoadedAsset loaded(packOf(ballClump({24, 32, 20}, 12, 3)));
  const Instance instance{loaded.asset.get(), nullptr};
  int last = -1;
  for (const double light : {0.0, 0.002, 0.01, 0.2, 0.5, 0.79, 0.9, 1.0, 1.5, 4.0, 100.0}) {
    SCOPED_TRACE(light);
    const std::string text =
        "vec4 kelpSurface(KelpSurface s) { return vec4(vec3(" + std::to_string(light) + "), 1.0); }\n";
    const auto renderer = makeRenderer(*loaded.asset, text.c_str());
    gl::View view = lookAt(canvas, {0, 0.5f, 1.2f}, {0, 0.5f, 0});
    const auto seen = [&] {
      canvas.clear();
      EXPECT_TRUE(renderer->draw(view, {&instance, 1}));
      for (const Pixel& pixel : canvas.pixels())
        if (pixel[3] == 255) return static_cast<int>(pixel[1]);
      ADD_FAILURE() << "nothing is drawn";
      return 0;
    };
    EXPECT_NEAR(seen(), 255 * std::min(light, 1.0), 1.0) << "linear is the default";
    view.output = gl::Output::kDisplay;
    const int got = seen();
    if (light < 0.8) {
      const double encoded = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
      EXPECT_NEAR(got, 255 * encoded, 1.0);
    }
    EXPECT_GT(got, last) << "brighter light is brighter on the screen";
    EXPECT_LE(got, 255);
    last = light < 4 ? got : -1;  // beyond, steps are less than one of 255
  }
}

TEST_P(LeftOutTest, EmptyPartsDrawNothingAndMoveTheOthers) {
  const Canvas canvas({64, 64});
  const RawPack plain = twoParts();
  RawPack hung = plain;
  RawPart joint = hung.parts[0];
  joint.name = "joint";
  joint.size = {500, 500, 500};
  joint.levels.clear();
  for (RawPart& part : hung.parts) part.parent = 0;
  hung.parts.insert(hung.parts.begin(), joint);
  const LoadedAsset without(plain), with(hung);
  const gl::View view = lookAt(canvas, {1, 1.5f, 3}, {0.4f, 0.5f, 0});
  const auto seen = [&](const LoadedAsset& loaded, const glm::vec3& by) {
    const auto renderer = makeRenderer(*loaded.asset);
    Pose pose = Pose::create(*loaded.asset).value();
    Instance instance{loaded.asset.get(), &pose};
    if (&loaded == &with)
      pose.motion(0)->translation = by;
    else
      instance.to_world[3] = glm::vec4(by, 1);
    canvas.clear();
    EXPECT_TRUE(renderer->draw(view, {&instance, 1}));
    return canvas.pixels();
  };
  EXPECT_EQ(seen(with, {0, 0, 0}), seen(without, {0, 0, 0}));
  const std::vector<Pixel> moved = seen(with, {0.5f, 0.25f, 0}), wanted = seen(without, {0.5f, 0.25f, 0});
  int different = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) different += moved[i] != wanted[i];
  EXPECT_LE(different, 8);
}

KELP_GL_TESTS(LeftOutTest);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Many instances: as many draws as batches, none that is seen left out, the same picture in whatever order
// and however many batches, nothing remembered, nothing allocated.
#include <algorithm>
#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "count_new.h"
#include "support/edit_knots.h"
#include "support/fake_gl.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;
using runtime::Pose;

// Instance, part and level into the color, so that pictures differ where anything else is drawn.
constexpr char kWhoSurface[] =
    "vec4 kelpSurface(KelpSurface s) { return vec4(float(s.color.r * 255.0 + 0.5), float(s.voxel.x + 16 * "
    "s.voxel.z), float(s.voxel.y), 255.0 - float(s.level)) / 255.0; }\n";

RawPack packOfTwoParts() {
  RawPack pack = packOf(ballClump({24, 32, 20}, 12, 5));
  pack.parts.push_back(partOf(ballClump({16, 20, 24}, 10, 6), figureKnots(kFigure6[1]), "second"));
  pack.parts[1].to_object[3] += glm::vec3(0.3f, 0.2f, -0.4f);
  return pack;
}

class InstancingTest : public GlTest {
 protected:
  // Instances of two assets, thrown into a heap around the origin, each with a pose of its own.
  void throwHeap(int count, unsigned seed, float spread) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    poses_.clear();
    instances_.clear();
    for (int i = 0; i < count; ++i) {
      const runtime::Asset& asset = i % 3 ? *one_.asset : *two_.asset;
      poses_.push_back(*Pose::create(asset));
      for (int part = 0; part < poses_.back().parts(); ++part)
        edit(poses_.back(), part, 32)[1].position += glm::vec3(8 * unit(random), 0, 8 * unit(random));
    }
    for (int i = 0; i < count; ++i) {
      Instance instance{i % 3 ? one_.asset.get() : two_.asset.get(),
                        i % 5 ? &poses_[static_cast<std::size_t>(i)] : nullptr};
      glm::mat4 m =
          glm::translate(glm::mat4(1), spread * glm::vec3(unit(random), unit(random), unit(random)));
      m = glm::rotate(m, 3 * unit(random), glm::vec3(unit(random), 1, unit(random)));
      instance.to_world = glm::scale(m, glm::vec3(i % 7 ? 0.6f : -0.6f, 0.6f, 0.5f + 0.2f * unit(random)));
      instance.tint = glm::vec4(static_cast<float>(1 + i % 200) / 204.0f, 1, 1, 1);
      instances_.push_back(instance);
    }
  }
  std::unique_ptr<gl::Renderer> makeBoth(gl::RendererOptions config = {}) {
    auto renderer = makeRenderer(*one_.asset, kWhoSurface, config);
    EXPECT_TRUE(renderer->add(*two_.asset));
    EXPECT_TRUE(renderer->upload(~std::uint64_t{0}));
    return renderer;
  }
  static std::vector<Pixel> drawn(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view,
                                  std::span<const Instance> instances, gl::Stats* stats = nullptr) {
    canvas.clear();
    const auto result = renderer.draw(view, instances);
    EXPECT_TRUE(result) << (result ? "" : result.error().detail);
    if (stats && result) *stats = *result;
    return canvas.pixels();
  }
  static int covered(const std::vector<Pixel>& pixels) {
    return static_cast<int>(
        std::count_if(pixels.begin(), pixels.end(), [](const Pixel& pixel) { return pixel[3] != 0; }));
  }

  const LoadedAsset one_{packOf(ballClump({24, 32, 20}, 14, 3))};
  const LoadedAsset two_{packOfTwoParts()};
  std::vector<Pose> poses_;
  std::vector<Instance> instances_;
};

TEST_P(InstancingTest, ManyInstancesAreOneDrawAndShowTheNearest) {
  const Canvas canvas({120, 90});
  const auto renderer = makeBoth();
  const gl::View view = lookAt(canvas, {0, 0.5f, 4}, {0, 0, 0});
  throwHeap(60, 1, 0.9f);
  gl::Stats stats;
  const std::vector<Pixel> together = drawn(*renderer, canvas, view, instances_, &stats);
  EXPECT_EQ(stats.draws, 1u);
  EXPECT_EQ(stats.instances + stats.culled, 80u);  // a third has two parts
  ASSERT_GT(covered(together), 2000);

  // One by one, with the depth test alone to sort them out. Where two are equally far, either may win.
  canvas.clear();
  for (const Instance& instance : instances_) ASSERT_TRUE(renderer->draw(view, {&instance, 1}));
  const std::vector<Pixel> apart = canvas.pixels();
  int differ = 0;
  for (std::size_t i = 0; i < apart.size(); ++i) differ += apart[i] != together[i];
  EXPECT_LE(differ, 2);
}

TEST_P(InstancingTest, TheOrderInTheSpanDoesNotShow) {
  const Canvas canvas({120, 90});
  const auto renderer = makeBoth();
  gl::View view = lookAt(canvas, {0, 0.5f, 4}, {0, 0, 0});
  throwHeap(60, 2, 0.9f);
  const std::vector<Pixel> first = drawn(*renderer, canvas, view, instances_);
  std::mt19937 random(4);
  for (const int batches : {1, 5}) {
    view.quality.depth_batches = batches;
    std::shuffle(instances_.begin(), instances_.end(), random);
    EXPECT_EQ(drawn(*renderer, canvas, view, instances_), first);
  }
}

TEST_P(InstancingTest, DepthBatchesDoNotChangeThePicture) {
  const Canvas canvas({120, 90});
  const auto renderer = makeBoth();
  throwHeap(60, 3, 0.9f);
  for (const bool wide : {true, false}) {
    gl::View view =
        wide ? lookAt(canvas, {0, 0.5f, 4}, {0, 0, 0}) : orthographic(canvas, {0, 0.5f, 4}, {0, 0, 0}, 1.2f);
    if (!wide) view.quality.pixels_per_voxel = 1;
    view.quality.depth_batches = 1;
    gl::Stats stats;
    const std::vector<Pixel> alone = drawn(*renderer, canvas, view, instances_, &stats);
    const std::uint32_t parts = stats.instances;
    const std::vector<float> depths = desktop() ? canvas.depths() : std::vector<float>();
    for (const int batches : {2, 3, 8, 16}) {
      view.quality.depth_batches = batches;
      EXPECT_EQ(drawn(*renderer, canvas, view, instances_, &stats), alone) << batches;
      EXPECT_EQ(stats.draws, static_cast<std::uint32_t>(batches));
      EXPECT_EQ(stats.instances, parts);
      if (desktop()) {
        EXPECT_EQ(canvas.depths(), depths) << batches;
      }
    }
  }
  gl::View view = lookAt(canvas, {0, 0.5f, 4}, {0, 0, 0});
  gl::Stats stats;
  view.quality.depth_batches = 16;  // never more than there are parts
  drawn(*renderer, canvas, view, std::span(instances_).subspan(1, 3), &stats);
  EXPECT_EQ(stats.draws, stats.instances + 0u);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  for (const int bad : {-1, 0, 17}) {
    view.quality.depth_batches = bad;
    EXPECT_FALSE(renderer->draw(view, instances_));
  }
}

TEST_P(InstancingTest, DepthBatchesWorkWithEveryDepthFormatAndLeaveOthersAlone) {
  const auto renderer = makeBoth();
  throwHeap(30, 5, 0.7f);
  struct Target {
    GLenum format;
    GLenum attachment;
    int samples;
    bool copied;
  };
  const Target targets[] = {{GL_DEPTH_COMPONENT16, GL_DEPTH_ATTACHMENT, 0, true},
                            {GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, 0, true},
                            {GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL_ATTACHMENT, 0, true},
                            {GL_DEPTH24_STENCIL8, GL_DEPTH_ATTACHMENT, 0, true},
                            {GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, 0, true},
                            {GL_DEPTH32F_STENCIL8, GL_DEPTH_STENCIL_ATTACHMENT, 0, true},
                            {GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, 4, false},
                            {GL_NONE, GL_NONE, 0, false}};
  for (const glm::ivec2 size : {glm::ivec2(64, 48), glm::ivec2(100, 80), glm::ivec2(40, 90)}) {
    for (const Target& target : targets) {
      GLuint framebuffer = 0, buffers[2] = {};
      glGenFramebuffers(1, &framebuffer);
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
      glGenRenderbuffers(2, buffers);
      glBindRenderbuffer(GL_RENDERBUFFER, buffers[0]);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, target.samples, GL_RGBA8, size.x, size.y);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
      if (target.format != GL_NONE) {
        glBindRenderbuffer(GL_RENDERBUFFER, buffers[1]);
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, target.samples, target.format, size.x, size.y);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, target.attachment, GL_RENDERBUFFER, buffers[1]);
      }
      ASSERT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
      const glm::ivec2 corner(6, 9);  // the viewport need not begin at the framebuffer's corner
      glViewport(corner.x, corner.y, size.x - corner.x, size.y - corner.y);
      gl::View view = lookAt(size - corner, {0, 0.5f, 3}, {0, 0, 0});
      std::vector<Pixel> pictures[2];
      for (const int batches : {1, 6}) {
        view.quality.depth_batches = batches;
        clearBound();
        const auto result = renderer->draw(view, instances_);
        ASSERT_TRUE(result);
        EXPECT_EQ(result->draws, batches > 1 && target.copied ? 6u : 1u)
            << std::hex << target.format << " " << target.attachment;
        if (target.samples == 0) pictures[batches > 1] = readBound(size);
      }
      EXPECT_EQ(pictures[0], pictures[1]) << std::hex << target.format;
      EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
      glDeleteFramebuffers(1, &framebuffer);
      glDeleteRenderbuffers(2, buffers);
    }
  }
}

// Against brute force: the instance by itself, in the same view, by a renderer that leaves out nothing,
// covers no pixel if it is culled.
TEST_P(InstancingTest, OnlyWhatCoversNoPixelIsCulled) {
  const Canvas canvas({90, 70});
  const auto renderer = makeBoth();
  throwHeap(250, 6, 3.0f);
  gl::View view = lookAt(canvas, {0, 0.2f, 1.2f}, {0, 0, 0}, 0.3f, 3.5f);
  view.quality.smallest_pixels = 0;
  // A view of everything around, in which the same part of the picture is drawn: the frustum's middle quarter
  // of a canvas four times as large.
  const Canvas large({450, 350});
  gl::View around = view;
  around.camera.viewport = large.size();
  around.camera.eye_to_clip[0] /= 5.0f;
  around.camera.eye_to_clip[1] /= 5.0f;
  int culled = 0, seen = 0;
  for (const Instance& instance : instances_) {
    glViewport(0, 0, 450, 350);
    const std::vector<Pixel> pixels = drawn(*renderer, large, around, {&instance, 1});
    int inside = 0;
    for (int y = 140; y < 210; ++y) {
      for (int x = 180; x < 270; ++x) inside += pixels[static_cast<std::size_t>(450 * y + x)][3] != 0;
    }
    const auto small = renderer->draw(view, {&instance, 1});
    ASSERT_TRUE(small);
    seen += small->instances > 0;
    if (small->instances > 0) continue;
    ++culled;
    EXPECT_EQ(inside, 0);
  }
  EXPECT_GT(culled, 100);
  EXPECT_GT(seen, 30);
}

// By size on the screen: what is left out is smaller than was said, and what is larger is drawn.
TEST_P(InstancingTest, SmallInstancesAreCulledBySize) {
  const Canvas canvas({100, 100});
  const auto renderer = makeBoth();
  gl::View view = orthographic(canvas, {0, 0, 5}, {0, 0, 0}, 1.0f);  // 50 pixels a meter
  int left_out = 0, drawn_parts = 0;
  for (float scale = 0.001f; scale < 1; scale *= 1.3f) {
    for (const float least : {0.0f, 0.5f, 3.0f}) {
      Instance instance{one_.asset.get(), nullptr};
      instance.to_world = glm::scale(glm::mat4(1), glm::vec3(scale));
      view.quality.smallest_pixels = least;
      const auto stats = renderer->draw(view, {&instance, 1});
      ASSERT_TRUE(stats);
      const float side = 50 * scale;  // the asset is a meter high
      if (side < 0.95f * least) {
        EXPECT_EQ(stats->culled, 1u) << scale;
      } else if (side > 1.05f * least) {
        EXPECT_EQ(stats->instances, 1u) << scale;
      }
      left_out += static_cast<int>(stats->culled);
      drawn_parts += static_cast<int>(stats->instances);
    }
  }
  EXPECT_GT(left_out, 10);
  EXPECT_GT(drawn_parts, 30);
}

TEST_P(InstancingTest, EachHasItsTint) {
  const Canvas canvas({100, 60});
  const auto renderer =
      makeRenderer(*one_.asset, "vec4 kelpSurface(KelpSurface s) { return vec4(s.color.rgb, 1.0); }\n");
  gl::View view = orthographic(canvas, {0, 0.5f, 5}, {0, 0.5f, 0}, 0.6f);
  Instance both[2] = {{one_.asset.get(), nullptr}, {one_.asset.get(), nullptr}};
  both[0].to_world[3].x = -0.6f;
  both[1].to_world[3].x = 0.6f;
  both[0].tint = {1, 0.5f, 0.25f, 1};
  both[1].tint = {0.25f, 1, 0.5f, 1};
  const glm::vec3 base(0.8f, 0.4f, 0.1f);
  const std::vector<Pixel> pixels = drawn(*renderer, canvas, view, both);
  int counts[2] = {};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i][3] == 0) continue;
    const int which = i % 100 < 50 ? 0 : 1;
    ++counts[which];
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(pixels[i][static_cast<std::size_t>(c)], 255 * base[c] * both[which].tint[c], 1.0f);
  }
  EXPECT_GT(counts[0], 300);
  EXPECT_GT(counts[1], 300);
}

// A pose may be shared, changed or gone when draw() has returned; so may matrices and the instances
// themselves.
TEST_P(InstancingTest, NothingIsRetained) {
  const Canvas canvas({120, 90});
  const auto renderer = makeBoth();
  const gl::View view = lookAt(canvas, {0, 0.5f, 4}, {0, 0, 0});
  throwHeap(20, 7, 0.8f);
  for (std::size_t i = 0; i < instances_.size(); ++i) instances_[i].pose = &poses_[i % 3 ? 1 : 0];  // shared
  const std::vector<Pixel> expected = drawn(*renderer, canvas, view, instances_);

  canvas.clear();
  {
    std::vector<Pose> copies;
    copies.reserve(2);
    for (int i = 0; i < 2; ++i) {
      copies.push_back(*Pose::create(i ? *one_.asset : *two_.asset));
      ASSERT_TRUE(copies.back().assign(poses_[static_cast<std::size_t>(i)]));
    }
    std::vector<Instance> same = instances_;
    for (std::size_t i = 0; i < same.size(); ++i) same[i].pose = &copies[i % 3 ? 1 : 0];
    ASSERT_TRUE(renderer->draw(view, same));
    for (Pose& pose : copies) {
      for (int part = 0; part < pose.parts(); ++part)
        for (Knot& knot : edit(pose, part)) knot.position = glm::vec3(NAN);
    }
    for (Instance& instance : same) instance = {};
  }
  EXPECT_EQ(canvas.pixels(), expected);
  // And the pose that moved since is seen to have moved.
  edit(poses_[1], 0, 32)[1].position.x += 20;
  EXPECT_NE(drawn(*renderer, canvas, view, instances_), expected);
}

KELP_GL_TESTS(InstancingTest);

// Hundreds of frames of spans that grow and shrink, on a GL that does nothing but count.
TEST(InstancingMemoryTest, NothingIsAllocatedOrMadeAnewAfterWarmUp) {
  for (const char* version : {"OpenGL ES 3.0 fake", "4.5 fake"}) {
    FakeGl fake;
    fake.version = version;
    fake.depth_bits = 24;
    FakeGl::current() = &fake;
    RawPack pack = packOf(ballClump({24, 32, 20}, 14, 3));
    pack.parts[0].bend = Bend::kSweep;
    const LoadedAsset one(pack);
    const LoadedAsset two(packOfTwoParts());
    gl::RendererOptions config;
    config.getProcAddress = FakeGl::getProcAddress;
    const auto renderer = gl::Renderer::create(config);
    ASSERT_TRUE(renderer);
    ASSERT_TRUE((*renderer)->add(*one.asset));
    ASSERT_TRUE((*renderer)->add(*two.asset));
    ASSERT_TRUE((*renderer)->upload(~std::uint64_t{0}));
    std::vector<Pose> poses;
    std::vector<Instance> instances;
    constexpr std::size_t kCount = 4000;  // of which 2,000 are swept
    for (std::size_t i = 0; i < kCount; ++i) poses.push_back(*Pose::create(i % 2 ? *one.asset : *two.asset));
    for (std::size_t i = 0; i < kCount; ++i) {
      instances.push_back({i % 2 ? one.asset.get() : two.asset.get(), &poses[i]});
      instances.back().to_world[3] =
          glm::vec4(static_cast<float>(i % 25) - 12, 0, -static_cast<float>(i / 25), 1);
    }
    gl::View view = lookAt(glm::ivec2(300, 200), {0, 4, 12}, {0, 0, 0});
    view.quality.pixels_per_voxel = 1;
    view.quality.depth_batches = 12;
    const auto frame = [&](int n) {
      const std::size_t count = 1 + static_cast<std::size_t>(0.5 * (1 + std::sin(0.2 * n)) * (kCount - 1));
      for (std::size_t i = 0; i < count; ++i) edit(poses[i], 0, 32)[1].position.x = static_cast<float>(n % 7);
      const auto some = std::span(instances).first(count);
      view.camera.world_to_eye = glm::lookAt(glm::vec3(4 * std::sin(0.12f * static_cast<float>(n)), 4, 12),
                                             glm::vec3(0), glm::vec3(0, 1, 0));
      const glm::mat4 before = view.camera.eye_to_clip * view.camera.world_to_eye;
      view.camera.previous_world_to_clip = n % 2 ? &before : nullptr;
      const auto color = (*renderer)->draw(view, some);
      EXPECT_TRUE(color && (*renderer)->draw(view, some, gl::Pass::kDepth) && (*renderer)->upload(100'000));
      return color ? color->draws : 0;
    };
    // Spans and views come again after 157 frames, so the largest are among them.
    for (int n = 0; n < 160; ++n) frame(n);
    const long news = newCalls(), made = fake.names_made, stored = fake.storage_made;
    std::uint32_t most = 0;
    for (int n = 160; n < 325; ++n) most = std::max(most, frame(n));
    EXPECT_EQ(most, 24u);  // twelve batches of sheared parts, and of swept ones
    EXPECT_EQ(newCalls(), news) << version;
    EXPECT_EQ(fake.names_made, made) << version;
    EXPECT_EQ(fake.storage_made, stored) << version;
    EXPECT_GT(stored, 0);
    EXPECT_GT(made, 0);
  }
}

// As many are drawn from far away, as records of fewer arcs; and none is left out.
TEST(InstancingMemoryTest, SweptPartsFartherAwayTakeFewerArcs) {
  FakeGl fake;
  FakeGl::current() = &fake;
  const fields::Occupancy column = ballClump({24, 90, 20}, 14, 3);
  const LoadedAsset loaded(sweptPackOf(column, 5));  // an S
  gl::RendererOptions config;
  config.getProcAddress = FakeGl::getProcAddress;
  const auto renderer = gl::Renderer::create(config);
  ASSERT_TRUE(renderer && (*renderer)->add(*loaded.asset) && (*renderer)->upload(~std::uint64_t{0}));
  const std::vector<Instance> instances(2000, Instance{loaded.asset.get()});
  const auto texelsFrom = [&](float distance, float pixels_per_voxel) {
    gl::View view = lookAt(glm::ivec2(1280, 720), {0, 0.5f, distance}, {0, 0.5f, 0}, 0.01f, 1e4f);
    view.quality.pixels_per_voxel = pixels_per_voxel;
    view.quality.smallest_pixels = 0;
    fake.texels_uploaded = 0;
    const auto drawn = (*renderer)->draw(view, instances);
    EXPECT_TRUE(drawn && drawn->instances == 2000 && drawn->left_out == 0);
    return static_cast<double>(fake.texels_uploaded) / 2000;
  };
  const double near = texelsFrom(1.5f, 1), away = texelsFrom(60, 1), very_far = texelsFrom(2000, 1);
  EXPECT_LT(away, 0.7 * near);
  EXPECT_LE(very_far, away);
  EXPECT_GT(very_far, 13 + 6 * 3);
  // Where the finest voxels are asked for, the arcs are as fine.
  EXPECT_EQ(texelsFrom(2000, 0), near);
}

}  // namespace
}  // namespace kelp::test

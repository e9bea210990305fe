// SPDX-License-Identifier: MIT
// A picture that is empty or wrong is explained: by an error, a number of Stats, or the log.
#include <algorithm>
#include <cmath>
#include <thread>

#include "canvas.h"
#include "support/fog_pack.h"
#include "support/scratch.h"

namespace kelp::test {
namespace {

using runtime::Instance;
using runtime::Pose;

class SilenceTest : public GlTest {
 protected:
  static inline std::vector<std::string> said;
  static std::unique_ptr<gl::Renderer> bare() {
    said.clear();
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = kGpuBudget;
    config.log = [](void*, const char* text) { said.push_back(text); };
    return std::move(gl::Renderer::create(config)).value();
  }
  static bool isEmpty(const Canvas& canvas) {
    const std::vector<Pixel> pixels = canvas.pixels();
    return std::all_of(pixels.begin(), pixels.end(), [](const Pixel& pixel) { return pixel == Pixel{}; });
  }
  static gl::View view() { return lookAt(kSize, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0}); }

  static constexpr glm::ivec2 kSize{80, 60};
  const RawPack pack_ = packOf(ballClump({60, 80, 50}, 20, 2));
  const LoadedAsset loaded_{pack_};
  const Instance instance_{loaded_.asset.get(), nullptr};
};

TEST_P(SilenceTest, DrawingBeforeAnythingIsLoadedSaysSo) {
  const Canvas canvas(kSize);
  const Scratch scratch;
  const std::vector<std::byte> bytes = bytesOf(pack_);
  const std::string path = scratch.write("fox.kelp", std::span<const std::byte>(bytes)).string();
  const auto asset = std::move(runtime::Asset::open(path.c_str())).value();
  const Instance fox{asset.get(), nullptr};
  const auto renderer = bare();
  renderer->add(*asset).value();
  for (int frame = 0; frame < 3; ++frame) {
    const gl::Stats stats = renderer->draw(view(), fox).value();
    EXPECT_EQ(stats.instances, 0u);
    EXPECT_EQ(stats.culled, 0u);
    EXPECT_EQ(stats.waiting, 1u);
    EXPECT_GT(stats.pending, 0u);
    EXPECT_GT(renderer->upload(1 << 20)->pending, 0u);
  }
  EXPECT_TRUE(isEmpty(canvas));
  EXPECT_EQ(said, std::vector<std::string>{"fox.kelp: nothing in memory yet; call Asset::pump()\n"});
  asset->loadAll().value();
  renderer->upload(~std::uint64_t{0}).value();
  const gl::Stats stats = renderer->draw(view(), fox).value();
  EXPECT_EQ(stats.instances, 1u);
  EXPECT_EQ(stats.waiting, 0u);
  EXPECT_EQ(stats.pending, 0u);
  EXPECT_FALSE(isEmpty(canvas));
  EXPECT_EQ(said.size(), 1u);
}

TEST_P(SilenceTest, DrawingBeforeAnythingIsUploadedSaysSo) {
  const Canvas canvas(kSize);
  const auto renderer = bare();
  renderer->add(*loaded_.asset).value();
  EXPECT_EQ(renderer->draw(view(), instance_)->waiting, 1u);
  const gl::Stats stats = renderer->draw(view(), instance_).value();
  EXPECT_EQ(stats.pending, static_cast<std::uint32_t>(loaded_.asset->pack().parts()[0].levels));
  EXPECT_EQ(said, std::vector<std::string>{"an asset: nothing on the GPU yet; call upload()\n"});
  renderer->remove(*loaded_.asset);
  EXPECT_EQ(renderer->draw(view(), {})->pending, 0u);
  renderer->add(*loaded_.asset).value();
  EXPECT_GT(renderer->draw(view(), instance_)->pending, 0u);
}

TEST_P(SilenceTest, OutOfViewIsNotTooSmall) {
  const Canvas canvas(kSize);
  const auto renderer = makeRenderer(*loaded_.asset);
  const auto far = [&](float x, float z) {
    Instance instance = instance_;
    instance.to_world[3] = {x, 0, z, 1};
    return instance;
  };
  gl::View wide = view();
  wide.camera.eye_to_clip = lookAt(kSize, {0, 0, 0}, {0, 0, -1}, 0.01f, 1e5f).camera.eye_to_clip;
  // In front; behind the eye; a thousand times as far as its size, and so less than half a pixel.
  const Instance three[] = {far(0, 0), far(0, 50), far(0, -900)};
  const gl::Stats stats = renderer->draw(wide, three).value();
  EXPECT_EQ(stats.instances, 1u);
  EXPECT_EQ(stats.culled, 2u);
  EXPECT_EQ(stats.too_small, 1u);
  wide.quality.smallest_pixels = 0;
  EXPECT_EQ(renderer->draw(wide, three)->too_small, 0u);
  EXPECT_EQ(renderer->draw(wide, three)->instances, 2u);
}

TEST_P(SilenceTest, AnAssetThatIsRemovedIsNotPending) {
  const auto renderer = makeRenderer(*loaded_.asset);
  const LoadedAsset other(pack_);
  ASSERT_TRUE(renderer->add(*other.asset));
  const Canvas canvas(kSize);
  EXPECT_GT(renderer->draw(view(), {})->pending, 0u);
  renderer->remove(*other.asset);
  EXPECT_EQ(renderer->draw(view(), {})->pending, 0u);
}

TEST_P(SilenceTest, APassForOtherPartsSaysSo) {
  const Canvas canvas(kSize);
  const LoadedAsset fog(fogPack(fogOf({16, 16, 16}, [](const glm::dvec3&) { return 1.0; }), 0.2f));
  const Instance cloud{fog.asset.get(), nullptr};
  const auto renderer = makeRenderer(*fog.asset);
  EXPECT_EQ(renderer->draw(view(), cloud)->other_kind, 1u);
  EXPECT_TRUE(isEmpty(canvas));
  const gl::Stats stats = renderer->draw(view(), cloud, gl::Pass::kFog).value();
  EXPECT_EQ(stats.other_kind, 0u);
  EXPECT_EQ(stats.instances, 1u);
}

TEST_P(SilenceTest, AViewportWithoutPixelsIsToldOnce) {
  const auto renderer = bare();
  for (int frame = 0; frame < 2; ++frame) EXPECT_TRUE(renderer->draw({}, {}));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("viewport"), std::string::npos);
}

TEST_P(SilenceTest, AnIncompleteFramebufferIsRefused) {
  const auto renderer = makeRenderer(*loaded_.asset);
  GLuint framebuffer = 0;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);  // without attachments
  const auto drawn = renderer->draw(view(), instance_);
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, ErrorCode::kMisuse);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  glDeleteFramebuffers(1, &framebuffer);
  const Canvas canvas(kSize);
  EXPECT_TRUE(renderer->draw(view(), instance_));
}

TEST_P(SilenceTest, AnotherContextOrThreadIsRefused) {
  auto renderer = makeRenderer(*loaded_.asset);
  {
    const Canvas canvas(kSize);
    ASSERT_TRUE(renderer->draw(view(), instance_));
  }
  const auto expectRefused = [&] {
    EXPECT_EQ(renderer->add(*loaded_.asset).error().code, ErrorCode::kMisuse);
    for (const Error& error : {renderer->upload(4096).error(), renderer->draw(view(), instance_).error(),
                               renderer->bindTrace(1, view(), instance_).error()}) {
      EXPECT_EQ(error.code, ErrorCode::kMisuse);
      EXPECT_NE(std::string(error.detail).find("context"), std::string::npos) << error.detail;
    }
  };
  std::thread(expectRefused).join();
  {
    const EglContext other(GetParam());
    ASSERT_TRUE(other);
    const Canvas canvas(kSize);
    expectRefused();
    EXPECT_TRUE(isEmpty(canvas));
    // The names of the renderer's objects are those of this context's own.
    const auto second = makeRenderer(*loaded_.asset);
    renderer.reset();
    ASSERT_TRUE(second->draw(view(), instance_));
    EXPECT_FALSE(isEmpty(canvas)) << "the other renderer took its objects away";
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  }
  EXPECT_TRUE(context_->makeCurrent());
}

// By the instance's wish a pose that cannot be drawn is drawn as clamp() makes it; many such in one list.
TEST_P(SilenceTest, AnUnsoundPoseIsLeftOutOrClamped) {
  const Canvas canvas(kSize);
  RawPack two = packOf(ballClump({24, 32, 20}, 12, 3));
  two.parts.push_back(partOf(ballClump({16, 20, 16}, 5, 2), two.parts[0].knots, "second"));
  two.parts[1].to_object[3] += glm::vec3(0.8f, 0, 0);
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    for (RawPart& part : two.parts) part.bend = bend;
    const LoadedAsset loaded(two);
    const auto renderer = makeRenderer(*loaded.asset, nullptr, [] {
      gl::RendererOptions config;
      config.log = [](void*, const char*) {};
      return config;
    }());
    std::vector<Pose> bad, good;
    std::vector<Instance> wishes, clamped;
    for (int i = 0; i < 5; ++i) {
      for (std::vector<Pose>* poses : {&bad, &good}) {
        poses->push_back(Pose::create(*loaded.asset).value());
        poses->back().move(i % 2, 1, {0.3f * static_cast<float>(i - 2), -2, 0}).value();
      }
      good.back().clamp();
    }
    for (std::size_t i = 0; i < 5; ++i) {
      Instance instance{loaded.asset.get(), &bad[i]};
      instance.to_world[3] = {0.4f * static_cast<float>(i) - 0.8f, 0, 0, 1};
      instance.unsound = runtime::Unsound::kClamp;
      wishes.push_back(instance);
      instance.pose = &good[i];
      clamped.push_back(instance);
    }
    const auto picture = [&](std::span<const Instance> list, std::uint32_t expected, std::uint32_t left_out) {
      canvas.clear();
      const gl::Stats stats = renderer->draw(view(), list).value();
      EXPECT_EQ(stats.clamped, expected);
      EXPECT_EQ(stats.left_out, left_out);
      return canvas.pixels();
    };
    const std::vector<Pixel> truth = picture(clamped, 0, 0);
    EXPECT_EQ(picture(wishes, 5, 0), truth);
    EXPECT_NE(truth, std::vector<Pixel>(truth.size()));
    // A matrix or a motion that is no number cannot be clamped.
    bad[2].motion(0)->translation.x = std::nanf("");
    picture(wishes, 5, 1);
    bad[2].reset();
    for (Instance& instance : wishes) instance.unsound = runtime::Unsound::kLeaveOut;
    picture(wishes, 0, 4);
  }
}

KELP_GL_TESTS(SilenceTest);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Several contexts, several threads, contexts that are lost: every renderer keeps to its own, and leaves
// nothing behind.
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <thread>

#include "canvas.h"
#include "watched_gl.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr glm::ivec2 kPixels{80, 60};

// A host with a context, a canvas and a renderer of its own.
class Host {
 public:
  explicit Host(GlApi api) : context_(api) {
    if (!context_) return;
    WatchedGl::enterGlThread();
    canvas_.emplace(kPixels);
    gl::RendererOptions config;
    config.getProcAddress = WatchedGl::getProcAddress;
    config.gpu_budget = kGpuBudget;
    config.surface_glsl = kVoxelSurface;
    auto created = gl::Renderer::create(config);
    EXPECT_TRUE(created);
    if (created) renderer_ = *std::move(created);
  }
  ~Host() {
    makeCurrent();
    renderer_.reset();
    canvas_.reset();
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  explicit operator bool() const { return renderer_ != nullptr; }
  void makeCurrent() const { EXPECT_TRUE(!context_ || context_.makeCurrent()); }
  gl::Renderer& renderer() { return *renderer_; }
  const Canvas& canvas() const { return *canvas_; }

  // A frame seen from one of several places. The context must be current.
  std::vector<Pixel> frame(int place, std::span<const Instance> instances) {
    canvas_->clear();
    const float angle = 0.7f * static_cast<float>(place);
    const auto drawn = renderer_->draw(
        lookAt(kPixels, {1.8f * std::sin(angle), 0.9f, 1.8f * std::cos(angle)}, {0, 0.5f, 0}), instances);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    return canvas_->pixels();
  }

 private:
  EglContext context_;
  std::optional<Canvas> canvas_;
  std::unique_ptr<gl::Renderer> renderer_;
};

// An asset whose pages are still to be pumped.
struct FreshAsset {
  explicit FreshAsset(const RawPack& pack)
      : bytes(bytesOf(pack)), source(bytes), asset(*runtime::Asset::open(source.source())) {}
  std::vector<std::byte> bytes;
  MemorySource source;
  std::unique_ptr<runtime::Asset> asset;
};

constexpr int kPlaces = 6;

class ContextsTest : public testing::Test {
 protected:
  // The pictures of a host that is alone. Empty where the machine has no such context.
  std::vector<std::vector<Pixel>> alone(GlApi api) {
    Host host(api);
    std::vector<std::vector<Pixel>> out;
    if (!host) return out;
    EXPECT_TRUE(host.renderer().add(*loaded_.asset));
    EXPECT_TRUE(host.renderer().upload(~std::uint64_t{0}));
    for (int place = 0; place < kPlaces; ++place) out.push_back(host.frame(place, {&instance_, 1}));
    return out;
  }

  const RawPack pack_ = packOf(ballClump({60, 80, 50}, 20, 2));
  const LoadedAsset loaded_{pack_};
  const Instance instance_{loaded_.asset.get(), nullptr};
};

TEST_F(ContextsTest, EveryVersionDrawsTheSame) {
  std::vector<std::vector<Pixel>> first;
  for (const GlApi api : kEveryApi) {
    const auto pictures = alone(api);
    if (pictures.empty()) continue;
    if (first.empty()) first = pictures;
    EXPECT_EQ(pictures, first) << toString(api);
  }
  if (first.empty()) GTEST_SKIP() << "no EGL device gives a context: install libegl1 libgl1-mesa-dri";
  EXPECT_NE(first[0], first[1]);
}

TEST_F(ContextsTest, TwoInOneThreadTakeTurns) {
  const auto expected = alone(GlApi::kDesktop33);
  for (const GlApi second_api : {GlApi::kDesktop33, GlApi::kEs30}) {
    Host first(GlApi::kDesktop33), second(second_api);
    if (!first || !second)
      GTEST_SKIP() << "no EGL device gives two contexts: install libegl1 libgl1-mesa-dri";
    for (Host* host : {&first, &second}) {
      host->makeCurrent();
      ASSERT_TRUE(host->renderer().add(*loaded_.asset));
    }
    for (std::uint32_t pending = 1; pending > 0;) {  // by turns, and one is always ahead
      pending = 0;
      for (Host* host : {&first, &second}) {
        host->makeCurrent();
        const auto uploaded = host->renderer().upload(8192);
        ASSERT_TRUE(uploaded);
        pending += uploaded->pending;
        host->frame(0, {&instance_, 1});
      }
    }
    for (int place = 0; place < kPlaces; ++place) {
      first.makeCurrent();
      EXPECT_EQ(first.frame(place, {&instance_, 1}), expected[static_cast<std::size_t>(place)]);
      second.makeCurrent();
      EXPECT_EQ(second.frame(kPlaces - 1 - place, {&instance_, 1}),
                expected[static_cast<std::size_t>(kPlaces - 1 - place)]);
    }
    first.makeCurrent();
    first.renderer().remove(*loaded_.asset);
    second.makeCurrent();  // the asset is still here
    EXPECT_EQ(second.frame(0, {&instance_, 1}), expected[0]);
  }
}

// Two threads draw an asset, each in a context of its own, while two others decode it: from nothing to the
// picture that a host alone sees.
TEST_F(ContextsTest, TwoThreadsDrawWhileOthersPump) {
  const auto expected = alone(GlApi::kDesktop33);
  if (expected.empty()) GTEST_SKIP() << "no EGL device gives a context: install libegl1 libgl1-mesa-dri";
  const FreshAsset fresh(pack_);
  const Instance instance{fresh.asset.get(), nullptr};
  const long strays = WatchedGl::strayCalls();
  std::atomic<int> begun{0}, ended{0};
  std::vector<std::thread> threads;
  for (const GlApi api : {GlApi::kDesktop33, GlApi::kEs30}) {
    threads.emplace_back([&, api] {
      Host host(api);
      if (host) {
        EXPECT_TRUE(host.renderer().add(*fresh.asset));
        EXPECT_NE(host.frame(0, {&instance, 1}), expected[0]) << "nothing was pumped yet";
      }
      ++begun;
      for (int place = 0; host && place < kPlaces; ++place) {
        bool same = false;
        const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(100);
        // long enough for the two to meet
        for (int frame = 0; std::chrono::steady_clock::now() < patience && !(same && frame > 20); ++frame) {
          EXPECT_TRUE(host.renderer().upload(4096));
          same = host.frame(place, {&instance, 1}) == expected[static_cast<std::size_t>(place)];
        }
        EXPECT_TRUE(same) << toString(api) << " from place " << place;
      }
      ++ended;
    });
  }
  for (int i = 0; i < 2; ++i) {
    threads.emplace_back([&] {
      while (begun < 2) std::this_thread::yield();
      while (ended < 2) {
        EXPECT_TRUE(fresh.asset->pump());
        std::this_thread::sleep_for(std::chrono::milliseconds(2));  // so that frames are drawn between pages
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(WatchedGl::strayCalls(), strays) << "OpenGL was called on a thread that has no context";
}

class LifeTest : public GlTest {
 protected:
  static gl::RendererOptions watchedConfig() {
    gl::RendererOptions config;
    config.getProcAddress = WatchedGl::getProcAddress;
    config.gpu_budget = kGpuBudget;
    config.surface_glsl = kVoxelSurface;
    return config;
  }

  // How many objects of each kind the context has. Names are small numbers where they are given out in a row,
  // as they are here.
  static std::map<std::string, int> objects() {
    const std::pair<const char*, GLboolean (*)(GLuint)> kinds[] = {
        {"textures", glIsTexture},           {"programs", glIsProgram}, {"shaders", glIsShader},
        {"vertex arrays", glIsVertexArray},  {"buffers", glIsBuffer},   {"framebuffers", glIsFramebuffer},
        {"renderbuffers", glIsRenderbuffer}, {"samplers", glIsSampler}, {"queries", glIsQuery},
    };
    std::map<std::string, int> out;
    for (const auto& [name, is] : kinds) {
      for (GLuint i = 1; i < 1024; ++i) out[name] += is(i);
    }
    return out;
  }

  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const Instance instance_{loaded_.asset.get(), nullptr};
  const gl::View view_ = lookAt(kPixels, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
};

TEST_P(LifeTest, DestroyingFreesEveryObject) {
  const Canvas canvas(kPixels);
  const auto before = objects();
  for (int life = 0; life < 2; ++life) {
    const auto renderer = gl::Renderer::create(watchedConfig());
    ASSERT_TRUE(renderer);
    ASSERT_TRUE((*renderer)->add(*loaded_.asset));
    ASSERT_TRUE((*renderer)->upload(~std::uint64_t{0}));
    ASSERT_TRUE((*renderer)->draw(view_, {&instance_, 1}));
    if (life) (*renderer)->remove(*loaded_.asset);
    const auto during = objects();
    EXPECT_GT(during.at("textures"), before.at("textures"));
    EXPECT_EQ(during.at("programs"), before.at("programs") + 1);
  }
  EXPECT_EQ(objects(), before);
}

TEST_P(LifeTest, ARefusedCreateFreesEveryObject) {
  const auto before = objects();
  gl::RendererOptions config = watchedConfig();
  // does not compile; does not link
  for (const char* surface : {"nonsense", "vec4 kelpSurface(KelpSurface s);\n"}) {
    config.surface_glsl = surface;
    EXPECT_FALSE(gl::Renderer::create(config));
  }
  EXPECT_EQ(objects(), before);
}

TEST_P(LifeTest, NothingIsCalledOnceTheContextIsLost) {
  std::vector<Pixel> expected;
  {
    auto renderer = gl::Renderer::create(watchedConfig());
    ASSERT_TRUE(renderer);
    ASSERT_TRUE((*renderer)->add(*loaded_.asset));
    ASSERT_TRUE((*renderer)->upload(~std::uint64_t{0}));
    {
      const Canvas canvas(kPixels);
      ASSERT_TRUE((*renderer)->draw(view_, {&instance_, 1}));
      expected = canvas.pixels();
    }
    context_.reset();
    const long calls = WatchedGl::calls();
    ASSERT_GT(calls, 0);
    for (int i = 0; i < 2; ++i) {  // twice is once
      (*renderer)->abandon();
      EXPECT_EQ((*renderer)->add(*loaded_.asset).error().code, ErrorCode::kMisuse);
      EXPECT_EQ((*renderer)->upload(1).error().code, ErrorCode::kMisuse);
      EXPECT_EQ((*renderer)->draw(view_, {&instance_, 1}).error().code, ErrorCode::kMisuse);
      EXPECT_EQ((*renderer)->draw(view_, {}, gl::Pass::kDepth).error().code, ErrorCode::kMisuse);
      (*renderer)->remove(*loaded_.asset);
    }
    *renderer = nullptr;
    EXPECT_EQ(WatchedGl::calls(), calls);
  }
  // And the host goes on in a new one, with the asset that it has.
  context_.emplace(GetParam());
  const Canvas canvas(kPixels);
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  ASSERT_TRUE(renderer->draw(view_, {&instance_, 1}));
  EXPECT_EQ(canvas.pixels(), expected);
}

TEST_P(LifeTest, AViewportWithoutPixelsDrawsNothingAndIsNoError) {
  const Canvas canvas(kPixels);
  const auto created = gl::Renderer::create(watchedConfig());
  ASSERT_TRUE(created);
  ASSERT_TRUE((*created)->add(*loaded_.asset));
  ASSERT_TRUE((*created)->upload(~std::uint64_t{0}));
  const long calls = WatchedGl::calls();
  for (const glm::ivec2 size : {glm::ivec2(0, 0), glm::ivec2(0, 60), glm::ivec2(80, 0)}) {
    gl::View view = view_;
    view.camera.viewport = size;
    view.camera.eye_to_clip = glm::mat4(std::nanf(""));  // the aspect ratio is 0 / 0
    for (const gl::Pass pass : {gl::Pass::kColor, gl::Pass::kDepth, gl::Pass::kFog}) {
      const auto drawn = (*created)->draw(view, {&instance_, 1}, pass);
      ASSERT_TRUE(drawn) << drawn.error().detail;
      EXPECT_EQ(drawn->draws, 0u);
    }
  }
  gl::View negative = view_;
  negative.camera.viewport.x = -80;
  EXPECT_EQ((*created)->draw(negative, {&instance_, 1}).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(WatchedGl::calls(), calls);
  glViewport(0, 0, 0, 0);  // the window was minimized, and the view does not know
  EXPECT_TRUE((*created)->draw(view_, {&instance_, 1}));
  for (const Pixel& pixel : canvas.pixels()) ASSERT_EQ(pixel, Pixel{});
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

KELP_EVERY_GL_TESTS(LifeTest);

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Shared by all tests here: a context, a framebuffer to draw into and read, a renderer with one asset on
// the GPU.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/gl/renderer.h"
#include "support/all_tests.h"
#include "support/egl_context.h"
#include "support/test_pack.h"

namespace kelp::test {

using Pixel = std::array<std::uint8_t, 4>;

// Of the framebuffer that is bound: clears color to zero and depth to 1; reads the colors, rows from bottom
// to top.
void clearBound();
std::vector<Pixel> readBound(const glm::ivec2& size);

// A framebuffer of RGBA8 and 32-bit float depth, bound while it lives. Rows from bottom to top.
class Canvas {
 public:
  explicit Canvas(glm::ivec2 size);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  glm::ivec2 size() const { return size_; }
  void clear() const;  // to zero, depth 1
  std::vector<Pixel> pixels() const;
  std::vector<float> depths() const;  // desktop only: OpenGL ES reads no depth

 private:
  glm::ivec2 size_;
  GLuint names_[2] = {};
  GLuint framebuffer_ = 0;
};

// An asset in memory, complete.
struct LoadedAsset {
  explicit LoadedAsset(const RawPack& pack, const runtime::AssetOptions& options = {});
  std::vector<std::byte> bytes;
  MemorySource source;
  std::unique_ptr<runtime::Asset> asset;
};

// A surface function that writes the voxel into red, green and blue, and 255 - level into alpha. Sides up to
// 256.
inline constexpr char kVoxelSurface[] =
    "vec4 kelpSurface(KelpSurface s) { return vec4(vec3(s.voxel), 255.0 - float(s.level)) / 255.0; }\n";

// Of the tests' renderers: more than their packs need. A software renderer clears all of it in every test.
inline constexpr std::uint64_t kGpuBudget = std::uint64_t{64} << 20;

class GlTest : public testing::TestWithParam<GlApi> {
 protected:
  void SetUp() override;
  // A renderer with the asset on the GPU. Fails the test if that cannot be had.
  std::unique_ptr<gl::Renderer> makeRenderer(const runtime::Asset& asset, const char* surface = nullptr,
                                             gl::RendererOptions config = {});
  bool desktop() const { return !isEs(GetParam()); }

  std::optional<EglContext> context_;
};

// Every test of the fixture runs with OpenGL 3.3 core and with OpenGL ES 3.0; under a sanitizer, which sees
// nothing of the driver, with the first alone.
inline constexpr GlApi kOldestApis[] = {GlApi::kDesktop33, GlApi::kEs30};
inline constexpr std::span<const GlApi> kMostApis = std::span(kOldestApis).first(kSanitized ? 1 : 2),
                                        kAllApis = kSanitized ? std::span<const GlApi>(kOldestApis)
                                                              : std::span<const GlApi>(kEveryApi);

#define KELP_GL_TESTS(fixture)                                                    \
  INSTANTIATE_TEST_SUITE_P(Gl, fixture, testing::ValuesIn(kelp::test::kMostApis), \
                           [](const auto& test) { return kelp::test::toString(test.param); })

// With every version there is, for what may depend on it; under a sanitizer with the two above.
#define KELP_EVERY_GL_TESTS(fixture)                                             \
  INSTANTIATE_TEST_SUITE_P(Gl, fixture, testing::ValuesIn(kelp::test::kAllApis), \
                           [](const auto& test) { return kelp::test::toString(test.param); })

// A perspective view from `eye` to `target`, all levels drawn as they are.
gl::View lookAt(const glm::ivec2& viewport, const glm::vec3& eye, const glm::vec3& target, float near = 0.01f,
                float far = 100.0f);
gl::View orthographic(const glm::ivec2& viewport, const glm::vec3& eye, const glm::vec3& target,
                      float half_height, float near = 0.01f, float far = 100.0f);
inline gl::View lookAt(const Canvas& canvas, const glm::vec3& eye, const glm::vec3& target,
                       float near = 0.01f, float far = 100.0f) {
  return lookAt(canvas.size(), eye, target, near, far);
}
inline gl::View orthographic(const Canvas& canvas, const glm::vec3& eye, const glm::vec3& target,
                             float half_height, float near = 0.01f, float far = 100.0f) {
  return orthographic(canvas.size(), eye, target, half_height, near, far);
}

// The ray through the center of a pixel, or of a place between them, from the near to the far plane: t = 0
// .. 1.
runtime::Ray pixelRay(const gl::View& view, double x, double y);

}  // namespace kelp::test

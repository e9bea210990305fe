// SPDX-License-Identifier: MIT
// Smoke of a real file, from the file to the picture: what it hides is the integral through it, at rest and
// bent.
#include <cmath>

#include "canvas.h"
#include "kelp/bake/bake.h"
#include "kelp/runtime/pose.h"
#include "support/assets.h"
#include "support/fog_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr glm::ivec2 kViewport(60, 90);

// Fog that is not seen straight along z, in colors that are not rounded.
class RealFog : public testing::Test {
 protected:
  void SetUp() override {
    if (!context_) GTEST_SKIP() << "no OpenGL 3.3 here";
    GLuint framebuffer, color;
    glGenFramebuffers(1, &framebuffer);
    glGenRenderbuffers(1, &color);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, color);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, kViewport.x, kViewport.y);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
    ASSERT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
    glViewport(0, 0, kViewport.x, kViewport.y);
  }
  static std::unique_ptr<gl::Renderer> rendererOf(const runtime::Asset& asset) {
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = kGpuBudget;
    auto renderer = gl::Renderer::create(config);
    EXPECT_TRUE(renderer && (*renderer)->add(asset) && (*renderer)->upload(~std::uint64_t{0}));
    return *std::move(renderer);
  }
  static std::vector<glm::vec4> draw(gl::Renderer& renderer, const gl::View& view, const Instance& instance) {
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    EXPECT_TRUE(renderer.draw(view, {&instance, 1}, gl::Pass::kFog));
    std::vector<glm::vec4> pixels(static_cast<std::size_t>(kViewport.x * kViewport.y));
    glReadPixels(0, 0, kViewport.x, kViewport.y, GL_RGBA, GL_FLOAT, pixels.data());
    return pixels;
  }

  const EglContext context_{GlApi::kDesktop33};
};

TEST_F(RealFog, MeanOpticalDepthIsThatOfTheFile) {
  KELP_ASSET(path, "vdb/gaffer_smoke.vdb");
  bake::Settings settings;
  settings.density = 0.02;  // thin enough for what comes through to tell its depth
  // tests/bake/vdb_fog_test.cpp compares this grid with the file's own values, through OpenVDB.
  const bake::SourceModel source = bake::importFile(path, settings);
  const bake::FogGrid& grid = *source.parts.at(0).fog;
  double mass = 0;  // optical depth of an edge, over all voxels
  for (const std::uint16_t density : grid.density) mass += double{grid.extinction} * density / 65535.0;
  bake::Report report;
  const LoadedAsset loaded(bake::bake(path, settings, report));
  const Instance instance{loaded.asset.get(), nullptr};
  const Box box = runtime::bounds(instance);
  const glm::vec3 middle = 0.5f * (box.min + box.max), extent = box.max - box.min;
  gl::View view = orthographic(kViewport, middle + glm::vec3(0, 0, extent.z), middle, 0.5f * extent.y * 1.02f,
                               0.01f, 2 * extent.z);
  view.quality.pixels_per_voxel = 0;
  // As many rays as make a grid finer than the voxels.
  const auto renderer = rendererOf(*loaded.asset);
  double sum = 0;
  constexpr int kShifts = 4;
  const double pixel = 1.02 * double{extent.y} / kViewport.y;
  for (int shift = 0; shift < kShifts * kShifts; ++shift) {
    gl::View shifted = view;
    const glm::vec3 by(pixel * (shift % kShifts) / kShifts, pixel * (shift / kShifts) / kShifts, 0);
    shifted.camera.world_to_eye[3] += glm::vec4(by, 0);
    for (const glm::vec4& at : draw(*renderer, shifted, instance)) sum -= std::log1p(-double{at.a});
  }
  const double voxel = double{extent.y} / grid.size.y;
  const double drawn = sum / (kShifts * kShifts) * pixel * pixel / (voxel * voxel);  // in the same unit
  std::printf("optical mass %.3f, drawn %.3f (%+.3f %%)\n", mass, drawn, 100 * (drawn / mass - 1));
  EXPECT_NEAR(drawn / mass, 1, 0.01);
}

TEST_F(RealFog, ThePictureIsTheIntegralAtRestAndBent) {
  KELP_ASSET(path, "vdb/gaffer_smoke.vdb");
  bake::Report report;
  const RawPack pack = bake::bake(path, {}, report);
  const LoadedAsset loaded(pack);
  const FogTruth truth(pack.parts[0], 0);
  const auto renderer = rendererOf(*loaded.asset);
  for (const FigurePose& figure : {kFigure6[0], kFigure6[1], kFigure6[2]}) {
    SCOPED_TRACE(figure.name);
    auto pose = runtime::Pose::create(*loaded.asset);
    ASSERT_TRUE(pose);
    const std::vector<Knot> knots = figureKnots(figure);
    (void)pose->setKnots(0, knots);
    const Instance instance{loaded.asset.get(), &*pose};
    const Box box = runtime::bounds(instance);
    const glm::vec3 middle = 0.5f * (box.min + box.max);
    const float reach = glm::length(box.max - box.min);
    gl::View view =
        lookAt(kViewport, middle + reach * glm::vec3(0.3f, 0.1f, 0.9f), middle, 0.01f * reach, 4 * reach);
    view.quality.pixels_per_voxel = 0;
    const std::vector<glm::vec4> drawn = draw(*renderer, view, instance);
    const glm::dmat4 to_part = glm::inverse(glm::dmat4(runtime::partToWorld(instance, 0).value()));
    double worst = 0, converged = 0, hidden = 0;
    for (int y = 1; y < kViewport.y; y += 6) {
      for (int x = 1; x < kViewport.x; x += 6) {
        const runtime::Ray ray = pixelRay(view, x, y);
        const glm::dvec3 o(to_part * glm::dvec4(ray.origin, 1)), d(to_part * glm::dvec4(ray.direction, 0));
        const double length = glm::length(d);
        const double coarse =
            1 - truth.look(knots, o, d / length, 0.15 * length, 0.6 * length, 1.0 / 4).through;
        const double fine =
            1 - truth.look(knots, o, d / length, 0.15 * length, 0.6 * length, 1.0 / 8).through;
        const double alpha = drawn[static_cast<std::size_t>(x + kViewport.x * y)].a;
        converged = std::max(converged, std::abs(fine - coarse));
        worst = std::max(worst, std::abs(alpha - fine));
        hidden += fine;
      }
    }
    std::printf("%s: off by %.3f of 255 at most; the truth by %.3f from one with half the step\n",
                figure.name, 255 * worst, 255 * converged);
    EXPECT_GT(hidden, 3);
    EXPECT_LT(255 * worst, 1.0);
  }
}

}  // namespace
}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// Fog against the integral that it stands for, in double precision; among solids and the host's own depth; and that nothing about a step is to be chosen.
#include <cmath>

#include "canvas.h"
#include "kelp/runtime/pose.h"
#include "support/fog_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr glm::ivec3 kSize(40, 56, 36);

// Colours that are not rounded. Desktop OpenGL draws into and blends them; of ES it is more than 3.0 promises.
class FloatCanvas {
 public:
  explicit FloatCanvas(const glm::ivec2& size, int samples = 0) : size_(size) {
    glGenFramebuffers(1, &framebuffer_);
    glGenRenderbuffers(2, names_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    const GLenum formats[2] = {GL_RGBA32F, GL_DEPTH_COMPONENT24}, places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, names_[i]);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, formats[i], size.x, size.y);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, names_[i]);
    }
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
    glViewport(0, 0, size.x, size.y);
  }
  ~FloatCanvas() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(2, names_);
  }
  FloatCanvas(const FloatCanvas&) = delete;
  FloatCanvas& operator=(const FloatCanvas&) = delete;

  const glm::ivec2& size() const { return size_; }
  void clear() const { clearBound(); }
  std::vector<glm::vec4> pixels() const {
    std::vector<glm::vec4> out(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y));
    glReadPixels(0, 0, size_.x, size_.y, GL_RGBA, GL_FLOAT, out.data());
    return out;
  }

 private:
  glm::ivec2 size_;
  GLuint framebuffer_ = 0, names_[2] = {};
};

class Fog : public GlTest {};

std::vector<glm::vec4> drawFog(gl::Renderer& renderer, const FloatCanvas& canvas, const gl::View& view, const Instance& instance) {
  canvas.clear();
  const auto drawn = renderer.draw(view, {&instance, 1}, gl::Pass::kFog);
  EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
  return canvas.pixels();
}

gl::View dark(gl::View view) {
  view.sun_color = view.sky_color = view.ground_color = glm::vec3(0);
  view.pixels_per_voxel = 0;
  return view;
}

// A stretch of a line in part space.
struct PartRay {
  glm::dvec3 o, r;
  double begin = 0, end = 0;
};
// A pixel's, where it is in the bounds.
PartRay partRay(const gl::View& view, const Instance& instance, const Box& bounds, int x, int y) {
  const runtime::Ray ray = pixelRay(view, x, y);
  const glm::dmat4 to_part = glm::inverse(glm::dmat4(runtime::partToWorld(instance, 0)));
  const glm::dvec3 o(to_part * glm::dvec4(ray.origin, 1)), d(to_part * glm::dvec4(ray.direction, 0));
  PartRay out{o, d / glm::length(d), 0, glm::length(d)};
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (double{bounds.min[axis]} - o[axis]) / out.r[axis], b = (double{bounds.max[axis]} - o[axis]) / out.r[axis];
    out.begin = std::max(out.begin, std::min(a, b));
    out.end = std::min(out.end, std::max(a, b));
  }
  return out;
}

// The whole of a posed instance.
gl::View framing(const glm::ivec2& viewport, const Instance& instance) {
  const Box box = runtime::bounds(instance);
  const glm::vec3 middle = 0.5f * (box.min + box.max);
  const float reach = glm::length(box.max - box.min);
  return lookAt(viewport, middle + reach * glm::vec3(0.35f, 0.2f, 0.9f), middle, 0.01f * reach, 4 * reach);
}

TEST_P(Fog, IsTheIntegralInEveryPose) {
  if (!desktop()) GTEST_SKIP() << "reads floats";
  const FloatCanvas canvas({16, 12});
  for (const bool glows : {false, true}) {
    const RawPack pack = fogPack(fogOf(kSize, puffs, glows ? FogShape([](const glm::dvec3& p) { return puffs(p) * p.y; }) : FogShape()), 0.21f);
    const LoadedAsset loaded(pack);
    const auto renderer = makeRenderer(*loaded.asset);
    ASSERT_TRUE(renderer);
    for (const int level : {0, 1}) {
      const FogTruth truth(pack.parts[0], level);
      for (const FigurePose& figure : kFigure6) {
        SCOPED_TRACE(std::string(figure.name) + " level " + std::to_string(level));
        auto pose = runtime::Pose::create(*loaded.asset);
        ASSERT_TRUE(pose);
        const std::vector<Knot> knots = figureKnots(figure, kSize);
        std::copy(knots.begin(), knots.end(), pose->knots(0).begin());
        const Instance instance{loaded.asset.get(), &*pose};
        gl::View view = dark(framing(canvas.size(), instance));
        const Box bounds = deformedBounds(knots, kSize);
        view.finest_level = level;
        const std::vector<glm::vec4> drawn = drawFog(*renderer, canvas, view, instance);
        double worst = 0, worst_glow = 0, sum = 0;
        for (int y = 0; y < canvas.size().y; ++y) {
          for (int x = 0; x < canvas.size().x; ++x) {
            const PartRay ray = partRay(view, instance, bounds, x, y);
            const FogSight sight = ray.begin < ray.end ? truth.look(knots, ray.o, ray.r, ray.begin, ray.end, 1.0 / 12) : FogSight();
            const glm::vec4& pixel = drawn[static_cast<std::size_t>(x + canvas.size().x * y)];
            worst = std::max(worst, std::abs(1 - sight.through - double{pixel.a}));
            for (int c = 0; c < 3; ++c) worst_glow = std::max(worst_glow, std::abs(sight.glow[c] - double{pixel[c]}));
            sum += 1 - sight.through;
          }
        }
        EXPECT_GT(sum, 0.01);
        EXPECT_LT(worst, 2.5e-4);  // an eighth of what 8 bits tell apart: the tangent stands for the curve within a cube
        EXPECT_LT(worst_glow, 2.0 / 255);
      }
    }
  }
}

}  // namespace

KELP_GL_TESTS(Fog);

}  // namespace kelp::test

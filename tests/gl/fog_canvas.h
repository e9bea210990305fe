// SPDX-License-Identifier: MIT
// The framebuffer of tests of fog, and the rays of its pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "canvas.h"
#include "kelp/runtime/pose.h"
#include "support/fog_pack.h"

namespace kelp::test {

using runtime::Instance;

// Colors that are not rounded. Desktop OpenGL draws into and blends them; of ES it is more than 3.0
// promises.
class FloatCanvas {
 public:
  explicit FloatCanvas(const glm::ivec2& size, int samples = 0) : size_(size) {
    glGenFramebuffers(1, &framebuffer_);
    glGenRenderbuffers(2, names_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    const GLenum formats[2] = {GL_RGBA32F, GL_DEPTH_COMPONENT24},
                 places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
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

inline std::vector<glm::vec4> drawFog(gl::Renderer& renderer, const FloatCanvas& canvas, const gl::View& view,
                                      const Instance& instance) {
  canvas.clear();
  const auto drawn = renderer.draw(view, {&instance, 1}, gl::Pass::kFog);
  EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
  return canvas.pixels();
}

inline double greatest(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(double{a[i][c]} - double{b[i][c]}));
  return most;
}

inline gl::View dark(gl::View view) {
  view.light.sun_color = view.light.sky_color = view.light.ground_color = glm::vec3(0);
  view.quality.pixels_per_voxel = 0;
  return view;
}

// A stretch of a line in part space.
struct PartRay {
  glm::dvec3 o, r;
  double begin = 0, end = 0;
};
// A pixel's, where it is in the bounds.
inline PartRay partRay(const gl::View& view, const Instance& instance, const Box& bounds, int x, int y) {
  const runtime::Ray ray = pixelRay(view, x, y);
  const glm::dmat4 to_part = glm::inverse(glm::dmat4(runtime::partToWorld(instance, 0).value()));
  const glm::dvec3 o(to_part * glm::dvec4(ray.origin, 1)), d(to_part * glm::dvec4(ray.direction, 0));
  PartRay out{o, d / glm::length(d), 0, glm::length(d)};
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (double{bounds.min[axis]} - o[axis]) / out.r[axis],
                 b = (double{bounds.max[axis]} - o[axis]) / out.r[axis];
    out.begin = std::max(out.begin, std::min(a, b));
    out.end = std::min(out.end, std::max(a, b));
  }
  return out;
}

// The whole of a posed instance.
inline gl::View framing(const glm::ivec2& viewport, const Instance& instance) {
  const Box box = runtime::bounds(instance);
  const glm::vec3 middle = 0.5f * (box.min + box.max);
  const float reach = glm::length(box.max - box.min);
  return lookAt(viewport, middle + reach * glm::vec3(0.35f, 0.2f, 0.9f), middle, 0.01f * reach, 4 * reach);
}

// While finer pages are missing, the coarser ones are drawn in their place: the mass is there from the first
// level on. `all`: a renderer that has all of the asset.
inline void expectCoarserUntilLoaded(gl::Renderer& all, runtime::Asset& asset) {
  const FloatCanvas canvas({40, 48});
  const Instance instance{&asset, nullptr};
  const gl::View view = dark(framing(canvas.size(), instance));
  const std::vector<glm::vec4> whole = drawFog(all, canvas, view, instance);
  const auto massOf = [](const std::vector<glm::vec4>& picture) {
    double sum = 0;
    for (const glm::vec4& pixel : picture) sum -= std::log(1 - std::min(double{pixel.a}, 0.9999));
    return sum;
  };
  gl::RendererOptions config;
  config.getProcAddress = EglContext::getProcAddress;
  config.gpu_budget = kGpuBudget;
  const auto slow = gl::Renderer::create(config);
  ASSERT_TRUE(slow && (*slow)->add(asset));
  int seen = 0;
  for (std::uint32_t pending = 1; pending > 0;) {
    const auto uploaded = (*slow)->upload(32768);
    ASSERT_TRUE(uploaded);
    pending = uploaded->pending;
    const std::vector<glm::vec4> now = drawFog(**slow, canvas, view, instance);
    const double mass = massOf(now);
    if (mass == 0) continue;  // the first level is not there yet
    ++seen;
    EXPECT_NEAR(mass / massOf(whole), 1, 0.05);
    if (pending == 0) {
      EXPECT_LT(greatest(now, whole), 1e-6);
    }
  }
  EXPECT_GT(seen, 5);
}

}  // namespace kelp::test

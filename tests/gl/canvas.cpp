// SPDX-License-Identifier: MIT
#include "canvas.h"

#include <glm/gtc/matrix_transform.hpp>

namespace kelp::test {

Canvas::Canvas(glm::ivec2 size) : size_(size) {
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glGenRenderbuffers(2, names_);
  glBindRenderbuffer(GL_RENDERBUFFER, names_[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size.x, size.y);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, names_[0]);
  glBindRenderbuffer(GL_RENDERBUFFER, names_[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, size.x, size.y);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, names_[1]);
  EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
  glViewport(0, 0, size.x, size.y);
  clear();
}

Canvas::~Canvas() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(2, names_);
}

void clearBound() {
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);  // the depth cleared to is 1 unless set otherwise
}

std::vector<Pixel> readBound(const glm::ivec2& size) {
  std::vector<Pixel> out(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
  return out;
}

void Canvas::clear() const { clearBound(); }

std::vector<Pixel> Canvas::pixels() const { return readBound(size_); }

std::vector<float> Canvas::depths() const {
  std::vector<float> out(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y));
  glReadPixels(0, 0, size_.x, size_.y, GL_DEPTH_COMPONENT, GL_FLOAT, out.data());
  return out;
}

LoadedAsset::LoadedAsset(const RawPack& pack, const runtime::AssetOptions& options)
    : bytes(bytesOf(pack)), source(bytes) {
  auto opened = runtime::Asset::open(source.source(), options);
  if (!opened || !(*opened)->loadAll()) {
    ADD_FAILURE() << "the test's own pack does not open";
    std::abort();
  }
  asset = *std::move(opened);
}

void GlTest::SetUp() {
  context_.emplace(GetParam());
  if (!*context_) GTEST_SKIP() << "no EGL device gives such a context: install libegl1 libgl1-mesa-dri";
}

std::unique_ptr<gl::Renderer> GlTest::makeRenderer(const runtime::Asset& asset, const char* surface,
                                                   gl::RendererOptions config) {
  config.getProcAddress = EglContext::getProcAddress;
  config.surface_glsl = surface;
  if (!config.log) config.log = [](void*, const char* text) { ADD_FAILURE() << text; };
  if (config.gpu_budget == gl::RendererOptions{}.gpu_budget) config.gpu_budget = kGpuBudget;
  auto renderer = gl::Renderer::create(config);
  if (!renderer) {
    ADD_FAILURE() << renderer.error().detail;
    std::abort();
  }
  EXPECT_TRUE((*renderer)->add(asset));
  const auto uploaded = (*renderer)->upload(~std::uint64_t{0});
  EXPECT_TRUE(uploaded) << (uploaded ? "" : uploaded.error().detail);
  return *std::move(renderer);
}

gl::View lookAt(const glm::ivec2& viewport, const glm::vec3& eye, const glm::vec3& target, float near,
                float far) {
  gl::View view;
  view.camera.world_to_eye = glm::lookAt(eye, target, glm::vec3(0, 1, 0));
  view.camera.eye_to_clip =
      glm::perspective(0.8f, static_cast<float>(viewport.x) / static_cast<float>(viewport.y), near, far);
  view.camera.viewport = viewport;
  view.quality.pixels_per_voxel = 0;
  return view;
}

gl::View orthographic(const glm::ivec2& viewport, const glm::vec3& eye, const glm::vec3& target,
                      float half_height, float near, float far) {
  gl::View view = lookAt(viewport, eye, target);
  const float half_width = half_height * static_cast<float>(viewport.x) / static_cast<float>(viewport.y);
  view.camera.eye_to_clip = glm::ortho(-half_width, half_width, -half_height, half_height, near, far);
  return view;
}

runtime::Ray pixelRay(const gl::View& view, double x, double y) {
  const glm::dmat4 to_world =
      glm::inverse(glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye));
  const glm::dvec2 at = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(view.camera.viewport) - 1.0;
  const glm::dvec4 near = to_world * glm::dvec4(at, -1, 1);
  const glm::dvec4 far = to_world * glm::dvec4(at, 1, 1);
  const glm::dvec3 from = glm::dvec3(near) / near.w;
  runtime::Ray ray;
  ray.origin = from;
  ray.direction = glm::dvec3(far) / far.w - from;
  ray.t_max = 1;
  return ray;
}

}  // namespace kelp::test

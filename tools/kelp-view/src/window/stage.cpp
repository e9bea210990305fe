// SPDX-License-Identifier: MIT
#include "window/stage.h"

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <utility>

namespace kelp::view {
namespace {

constexpr std::uint64_t kUploadPerFrame = 8 << 20;  // bytes

std::string makeRenderer(const Model& model, Surface surface, std::unique_ptr<gl::Renderer>& renderer) {
  gl::RendererOptions config;
  config.getProcAddress = [](void*, const char* name) {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
  };
  config.surface_glsl = glslOf(surface);
  if (surface == Surface::kDistances) config.features = gl::Features::kDistances;
  auto made = gl::Renderer::create(config);
  if (!made) return describe(made.error());
  if (const auto added = (*made)->add(model.asset()); !added) return describe(added.error());
  renderer = *std::move(made);
  return {};
}

gl::DebugView debugOf(Surface surface) {
  if (surface < Surface::kParts) return gl::DebugView::kNone;
  return static_cast<gl::DebugView>(static_cast<int>(surface) - static_cast<int>(Surface::kParts) +
                                    static_cast<int>(gl::DebugView::kParts));
}

}  // namespace

std::string Stage::show(std::unique_ptr<Model> model) {
  if (renderer_) {  // its programs are made already
    if (const auto added = renderer_->add(model->asset()); !added) return describe(added.error());
    renderer_->remove(model_->asset());
  } else if (std::string wrong = makeRenderer(*model, surface_, renderer_); !wrong.empty()) {
    return wrong;
  }
  model_ = std::move(model);
  complete_ = false;
  return {};
}

std::string Stage::paint(Surface surface) {
  if (model_ && !shareRenderer(surface_, surface)) {
    std::unique_ptr<gl::Renderer> renderer;
    if (std::string wrong = makeRenderer(*model_, surface, renderer); !wrong.empty()) return wrong;
    renderer_ = std::move(renderer);
  }
  surface_ = surface;
  return {};
}

std::string Stage::draw(const OrbitCamera& camera, const glm::ivec2& viewport, float pixels_per_voxel) {
  if (viewport.x == 0 || viewport.y == 0) return {};  // minimized
  glViewport(0, 0, viewport.x, viewport.y);
  glClearColor(0.15f, 0.18f, 0.21f, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (!model_) return {};

  const bool all_read = model_->loaded();
  const auto sent = renderer_->upload(kUploadPerFrame);
  if (!sent) return describe(sent.error());
  gl::View view;
  view.camera.world_to_eye = camera.worldToEye();
  view.camera.eye_to_clip = camera.eyeToClip();
  view.camera.viewport = viewport;
  view.quality.pixels_per_voxel = pixels_per_voxel;
  view.debug = debugOf(surface_);
  const runtime::Instance instance = model_->instance();
  if (surface_ == Surface::kDistances) {
    if (!model_->asset().loadsDistances())
      return "the pack holds no distances; bake it again without --no-distance";
    stats_ = *sent;
    complete_ = all_read && sent->pending == 0;
    return slice_.draw(*renderer_, view, instance, camera.toTarget());
  }
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);
  const auto drawn = renderer_->draw(view, {&instance, 1});
  const auto fog = renderer_->draw(view, {&instance, 1}, gl::Pass::kFog);
  glDisable(GL_FRAMEBUFFER_SRGB);  // the panel's colors are encoded already
  if (!drawn || !fog) return describe(drawn ? fog.error() : drawn.error());
  stats_ = *drawn;
  stats_.instances += fog->instances;
  stats_.culled += fog->culled;
  stats_.draws += fog->draws;
  stats_.bytes_uploaded = sent->bytes_uploaded;
  stats_.pending = sent->pending;
  complete_ = all_read && sent->pending == 0;
  return {};
}

}  // namespace kelp::view

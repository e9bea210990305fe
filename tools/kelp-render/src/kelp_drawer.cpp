// SPDX-License-Identifier: MIT
// Draws by kelp's own method: kelp::gl::Renderer.
#include <cstdio>

#include "drawer.h"
#include "gl_program.h"
#include "glsl.h"
#include "headless_context.h"
#include "kelp/common/pack_error.h"

namespace kelp::render {
namespace {

class KelpDrawer final : public Drawer {
 public:
  KelpDrawer(const Options& options, const ViewStyle& style, const Scene& scene, bool es)
      : colors_(style.colors), es_(es) {
    gl::Config config;
    config.getProcAddress = HeadlessContext::getProcAddress;
    config.surface_glsl = style.surface.empty() ? nullptr : style.surface.c_str();
    config.secondary_rays = options.shadows || options.occlusion > 0;
    config.log = [](void*, const char* text) { std::fputs(text, stderr); };
    // Room for every voxel, in whole layers of 4 MiB: a picture has no frame rate to keep.
    config.gpu_budget = std::uint64_t{8} << 20;
    for (const auto& [path, pack] : scene.packs()) config.gpu_budget += gl::poolBytes(*pack);
    renderer_ = checkPack("OpenGL", gl::Renderer::create(config));
    for (const auto& [path, pack] : scene.packs()) checkPack(path, renderer_->add(*pack));
    checkPack("OpenGL", renderer_->upload(~std::uint64_t{0}));
  }

  void draw(const gl::View& view, std::span<const runtime::Instance> instances) override {
    checkPack("OpenGL", renderer_->draw(view, instances));
    if (colors_) checkPack("OpenGL", renderer_->draw(view, instances, gl::Pass::kFog));
  }

  StepCount count(const gl::View& view, std::span<const runtime::Instance> instances,
                  CountTarget& target) override {
    if (!counter_) {
      std::vector<const char*> text{"#define KELP_HOST_SURFACE\n"};
      text.insert(text.end(), renderer_->traceGlsl().begin(), renderer_->traceGlsl().end());
      text.push_back(glsl::kKelpCount);
      counter_ = std::make_unique<GlProgram>(text, es_);
    }
    target.bind();
    target.clear();
    checkPack("OpenGL", renderer_->bindTrace(counter_->name(), view, instances));
    counter_->use();
    const glm::dmat4 world_to_clip =
        glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye);
    counter_->set("count_clip_to_world", glm::mat4(glm::inverse(world_to_clip)));
    counter_->set("count_viewport", glm::vec2(target.size()));
    const glm::vec4 everything(-1, -1, 1, 1);
    counter_->drawRectangle(everything);
    return target.read(everything);
  }

 private:
  bool colors_, es_;
  std::unique_ptr<gl::Renderer> renderer_;
  std::unique_ptr<GlProgram> counter_;
};

}  // namespace

std::unique_ptr<Drawer> makeKelpDrawer(const Options& options, const ViewStyle& style, const Scene& scene,
                                       bool es) {
  return std::make_unique<KelpDrawer>(options, style, scene, es);
}

}  // namespace kelp::render

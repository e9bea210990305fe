// SPDX-License-Identifier: MIT
// Draws by kelp's own method: kelp::gl::Renderer.
#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <cstdio>

#include "drawer.h"
#include "gl_program.h"
#include "glsl.h"
#include "headless_context.h"
#include "kelp/common/distance_slice.h"
#include "kelp/common/pack_error.h"

namespace kelp::render {
namespace {

class KelpDrawer final : public Drawer {
 public:
  KelpDrawer(const Options& options, const ViewStyle& style, const Scene& scene, bool es)
      : colors_(style.colors), es_(es), slice_(options.view == ViewKind::kDistance) {
    gl::RendererOptions config;
    config.getProcAddress = HeadlessContext::getProcAddress;
    config.surface_glsl =
        style.surface.empty() || style.debug != gl::DebugView::kNone ? nullptr : style.surface.c_str();
    if ((options.shadows && options.soft_shadows == 0) || options.occlusion > 0)
      config.features = gl::Features::kSecondaryRays;
    if (slice_ || options.shadesByDistances()) config.features = config.features | gl::Features::kDistances;
    config.log = [](void*, const char* text) { std::fputs(text, stderr); };
    // Room for every voxel, in whole layers of 4 MiB: a picture has no frame rate to keep.
    config.gpu_budget = std::uint64_t{8} << 20;
    for (const auto& [key, pack] : scene.packs()) config.gpu_budget += gl::poolBytes(*pack, config.features);
    renderer_ = checkPack("OpenGL", gl::Renderer::create(config));
    for (const auto& [key, pack] : scene.packs()) checkPack(key.path, renderer_->add(*pack));
    checkPack("OpenGL", renderer_->upload(~std::uint64_t{0}));
    glLineWidth(static_cast<float>(options.samples));  // a pixel of the picture
  }

  void draw(const gl::View& view, std::span<const runtime::Instance> instances) override {
    if (slice_) return drawSlice(view, instances);
    checkPack("OpenGL", renderer_->draw(view, instances));
    if (colors_) checkPack("OpenGL", renderer_->draw(view, instances, gl::Pass::kFog));
  }

  StepCount count(const gl::View& view, std::span<const runtime::Instance> instances,
                  CountTarget& target) override {
    target.bind();
    target.clear();
    const GlProgram& counter = bind(counter_, glsl::kKelpCount, view, instances);
    counter.set("count_clip_to_world", clipToWorld(view));
    counter.set("count_viewport", glm::vec2(target.size()));
    counter.drawRectangle(kEverything);
    return target.read(kEverything);
  }

 private:
  static constexpr glm::vec4 kEverything{-1, -1, 1, 1};

  static glm::mat4 clipToWorld(const gl::View& view) {
    return glm::mat4(
        glm::inverse(glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye)));
  }
  // A program of this text, after the renderer's, with everything that it traces.
  const GlProgram& bind(std::unique_ptr<GlProgram>& program, const char* own, const gl::View& view,
                        std::span<const runtime::Instance> instances) {
    if (!program) {
      std::vector<const char*> text{"#define KELP_HOST_SURFACE\n"};
      text.insert(text.end(), renderer_->traceGlsl().begin(), renderer_->traceGlsl().end());
      text.push_back(own);
      program = std::make_unique<GlProgram>(text, es_);
    }
    checkPack("OpenGL", renderer_->bindTrace(program->name(), view, instances));
    program->use();
    return *program;
  }
  void drawSlice(const gl::View& view, std::span<const runtime::Instance> instances) {
    const glm::mat4& to_clip = view.camera.eye_to_clip;
    const float middle = 0.5f * (DistanceSlice::nearOf(to_clip) + DistanceSlice::farOf(to_clip));
    const DistanceSlice slice(view.camera.world_to_eye, to_clip, middle);
    const GlProgram& program = bind(slicer_, kDistanceSlice, view, instances);
    program.set("slice_clip_to_world", slice.clip_to_world);
    program.set("slice_viewport", glm::vec2(view.camera.viewport));
    program.set("slice_at", slice.at);
    program.set("slice_contour", slice.contour);
    program.drawRectangle(kEverything);
  }

  bool colors_, es_, slice_;
  std::unique_ptr<gl::Renderer> renderer_;
  std::unique_ptr<GlProgram> counter_, slicer_;
};

}  // namespace

std::unique_ptr<Drawer> makeKelpDrawer(const Options& options, const ViewStyle& style, const Scene& scene,
                                       bool es) {
  return std::make_unique<KelpDrawer>(options, style, scene, es);
}

}  // namespace kelp::render

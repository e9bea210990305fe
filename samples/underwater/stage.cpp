// SPDX-License-Identifier: MIT
#include "stage.h"

#include <cmath>
#include <cstdio>

#include "scenery.h"
#include "terrain.h"

namespace underwater {
namespace {

constexpr std::uint64_t kUploadPerFrame = 8 << 20;  // bytes
constexpr int kSunMapSize = 1024;                   // pixels: 25 mm of sand each
constexpr float kFloorRadius = 45;                  // meters: where the sand's edge is lost in the water
const glm::vec3 kSun = glm::normalize(glm::vec3(0.28f, 1.0f, -0.42f));

// kelp's View::bind: the sun's map for the surface function. In the map's own pass there is none yet: `map`
// is null.
void bindSunMap(void* map, std::uint32_t program) {
  glUniform1i(glGetUniformLocation(program, "water_sun_map"), kelp::gl::kFirstHostUnit);
  glActiveTexture(GL_TEXTURE0 + kelp::gl::kFirstHostUnit);
  glBindTexture(GL_TEXTURE_2D, map ? static_cast<const SunMap*>(map)->texture() : 0);
}

}  // namespace

Stage::Stage() : floor_(kFloorRadius), sun_map_(kSunMapSize) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_CULL_FACE);
  glEnable(GL_FRAMEBUFFER_SRGB);  // colors are linear until they are stored
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
}

kelp::Result<std::unique_ptr<Stage>> Stage::build(const Library& library) {
  std::unique_ptr<Stage> stage(new Stage);
  if (!stage->water_.good() || !stage->floor_.good())
    return kelp::Error{kelp::ErrorCode::kGraphics, "the scene's shaders do not compile"};
  const std::string surface = std::string(glsl::kWater) + glsl::kVoxels;
  kelp::gl::RendererOptions config;
  config.getProcAddress = [](void*, const char* name) {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
  };
  config.surface_glsl = surface.c_str();
  config.log = [](void*, const char* text) { std::fprintf(stderr, "underwater: %s\n", text); };
  auto renderer = kelp::gl::Renderer::create(config);
  if (!renderer) return renderer.error();
  stage->renderer_ = *std::move(renderer);
  for (int i = 0; i < kSpecies; ++i) {
    if (const auto added = stage->renderer_->add(library.asset(static_cast<Species>(i))); !added)
      return added.error();
  }
  return stage;
}

kelp::Result<kelp::gl::Stats> Stage::draw(const Camera& camera, double seconds, const glm::ivec2& viewport,
                                          std::span<const kelp::runtime::Instance> instances) {
  const auto sent = renderer_->upload(kUploadPerFrame);
  if (!sent) return sent.error();

  kelp::gl::View sun;
  sun.camera = {SunMap::worldToSun(kSun), SunMap::sunToClip(1.15f * kReefRadius, kSurface),
                glm::ivec2(sun_map_.size())};
  sun.bind = bindSunMap;
  sun_map_.begin();
  const auto shadows = renderer_->draw(sun, instances, kelp::gl::Pass::kDepth);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (!shadows) return shadows.error();

  kelp::gl::View view;
  view.camera = {camera.worldToEye(), Camera::eyeToClip(viewport), viewport};
  view.light.sun_direction = kSun;
  view.quality.shading = kelp::gl::Shading::kSmooth;
  view.bind = bindSunMap;
  view.bind_user = &sun_map_;
  WaterBlock water;
  water.world_to_clip = view.camera.eye_to_clip * view.camera.world_to_eye;
  water.clip_to_world = glm::inverse(water.world_to_clip);
  const glm::mat4 to_texture(glm::vec4(0.5f, 0, 0, 0), glm::vec4(0, 0.5f, 0, 0), glm::vec4(0, 0, 0.5f, 0),
                             glm::vec4(0.5f, 0.5f, 0.5f, 1));
  water.world_to_sun = to_texture * sun.camera.eye_to_clip * sun.camera.world_to_eye;
  water.eye = glm::vec4(camera.at(), std::fmod(seconds, 3600.0));
  water.sun = glm::vec4(kSun, kSurface);
  water_.set(water);

  glViewport(0, 0, viewport.x, viewport.y);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  floor_.draw(sun_map_.texture());
  auto drawn = renderer_->draw(view, instances);
  if (!drawn) return drawn;
  water_.drawBackground();
  drawn->bytes_uploaded = sent->bytes_uploaded;
  drawn->pending = sent->pending;
  return drawn;
}

}  // namespace underwater

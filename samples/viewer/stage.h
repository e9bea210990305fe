// SPDX-License-Identifier: MIT
// The model on the stage and the renderer that draws it. Needs the OpenGL context to be current, also when it goes.
#pragma once

#include <memory>
#include <string>

#include "kelp/gl/renderer.h"
#include "model.h"
#include "orbit_camera.h"

namespace viewer {

// What the colours mean. Every one but kShaded is a surface function of the viewer's own (kelp::gl::Config::surface_glsl).
enum class Surface { kShaded, kNormals, kLevels, kSteps, kCount };
const char* toString(Surface surface);

class Stage {
 public:
  Model* model() { return model_.get(); }
  Surface surface() const { return surface_; }

  // Both answer an empty line, or what is wrong; then everything stays as it was.
  std::string show(std::unique_ptr<Model> model);
  std::string paint(Surface surface);

  // Sends voxels to the GPU and draws. Answers an empty line, or what is wrong.
  std::string draw(const OrbitCamera& camera, const glm::ivec2& viewport, float pixels_per_voxel);
  const kelp::gl::Stats& stats() const { return stats_; }  // of the last draw()
  bool complete() const { return complete_; }              // whether it showed every voxel that will ever come

 private:
  std::unique_ptr<Model> model_;
  std::unique_ptr<kelp::gl::Renderer> renderer_;  // goes before the model that it knows
  Surface surface_ = Surface::kShaded;
  kelp::gl::Stats stats_;
  bool complete_ = false;
};

}  // namespace viewer

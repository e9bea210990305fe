// SPDX-License-Identifier: MIT
// The model that is shown, and the renderer that draws it. Keep the OpenGL context current in every call and
// in the destructor.
#pragma once

#include <memory>
#include <string>

#include "kelp/gl/renderer.h"
#include "model.h"
#include "orbit_camera.h"
#include "surface.h"
#include "window/slice.h"

namespace kelp::view {

class Stage {
 public:
  Model* model() { return model_.get(); }
  const Model* model() const { return model_.get(); }
  Surface surface() const { return surface_; }

  // Both answer an empty text, or what is wrong; after an error everything stays as it was.
  std::string show(std::unique_ptr<Model> model);
  std::string paint(Surface surface);

  // Sends voxels to the GPU and draws. Answers an empty text, or what is wrong.
  std::string draw(const OrbitCamera& camera, const glm::ivec2& viewport, float pixels_per_voxel);
  const gl::Stats& stats() const { return stats_; }  // of the last draw()
  // True once every voxel is loaded and was drawn.
  bool complete() const { return complete_; }

 private:
  std::unique_ptr<Model> model_;
  std::unique_ptr<gl::Renderer> renderer_;  // destroyed before the model that it draws
  Slice slice_;
  Surface surface_ = Surface::kShaded;
  gl::Stats stats_;
  bool complete_ = false;
};

}  // namespace kelp::view

// SPDX-License-Identifier: MIT
// One frame on the screen: the sun's shadow map, the sea floor, plants and fish, the water behind it all.
#pragma once

#include <memory>

#include "camera.h"
#include "kelp/gl/renderer.h"
#include "library.h"
#include "scenery.h"

namespace underwater {

// Needs the OpenGL context to be current, also when it goes.
class Stage {
 public:
  // Sets the OpenGL state of the scene, once: kelp leaves the state as it finds it.
  static kelp::Result<std::unique_ptr<Stage>> build(const Library& library);

  // Sends voxels that have been read, as many as a frame may; then pending in the answer tells of more to
  // send. The rest is of what was drawn.
  kelp::Result<kelp::gl::Stats> draw(const Camera& camera, double seconds, const glm::ivec2& viewport,
                                     std::span<const kelp::runtime::Instance> instances);

 private:
  Stage();

  Water water_;
  SeaFloor floor_;
  SunMap sun_map_;
  std::unique_ptr<kelp::gl::Renderer> renderer_;
};

}  // namespace underwater

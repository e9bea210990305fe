// SPDX-License-Identifier: MIT
// The uniform block that all shaders of the scene share, and the background.
#pragma once

#include <glm/glm.hpp>

#include "program.h"

namespace underwater {

// As `Water` in water.glsl, std140.
struct WaterBlock {
  glm::mat4 world_to_clip{1};
  glm::mat4 clip_to_world{1};
  glm::mat4 world_to_sun{1};  // to the shadow map, 0 .. 1
  glm::vec4 eye{0};           // w: seconds
  glm::vec4 sun{0, 1, 0, 0};  // towards it, unit; w: height of the surface, meters
};
static_assert(sizeof(WaterBlock) == 3 * 64 + 2 * 16);

// Needs the context of its creation, also when it goes.
class Water {
 public:
  Water();
  ~Water();
  Water(const Water&) = delete;
  Water& operator=(const Water&) = delete;

  bool good() const { return background_ != 0; }
  // Binds the block to binding point 0. That is where a block is taken from whose program says nothing else:
  // also kelp's program with a surface_glsl that declares it.
  void set(const WaterBlock& block) const;
  void drawBackground() const;  // behind everything: wants the depth test LEQUAL

 private:
  GLuint block_ = 0, background_ = 0, no_vertices_ = 0;
};

}  // namespace underwater

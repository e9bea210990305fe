// SPDX-License-Identifier: MIT
#include "water.h"

#include "glsl.h"

namespace underwater {

Water::Water() : background_(makeProgram("background", glsl::kBackgroundVertex, glsl::kBackgroundFragment)) {
  glGenBuffers(1, &block_);
  glBindBuffer(GL_UNIFORM_BUFFER, block_);
  glBufferData(GL_UNIFORM_BUFFER, sizeof(WaterBlock), nullptr, GL_DYNAMIC_DRAW);
  glGenVertexArrays(1, &no_vertices_);
}

Water::~Water() {
  glDeleteVertexArrays(1, &no_vertices_);
  glDeleteBuffers(1, &block_);
  glDeleteProgram(background_);
}

void Water::set(const WaterBlock& block) const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, block_);
  glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof block, &block);
}

void Water::drawBackground() const {
  glUseProgram(background_);
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace underwater

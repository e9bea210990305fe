// SPDX-License-Identifier: MIT
// GLSL programs of kelp-render's own: compiled, linked, and their uniforms set by name.
#pragma once

#include <initializer_list>
#include <span>

#include <glm/mat4x4.hpp>

namespace kelp::render {

class GlProgram {
 public:
  // Draws a rectangle of the picture with the fragment shader whose text these strings are, after the version
  // and the default precisions. ToolError kRuntime with the compiler's words if they do not compile.
  GlProgram(std::span<const char* const> fragment, bool es);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  unsigned name() const { return name_; }
  void use() const;
  // Of the program in use. A uniform that the program does not read is ignored.
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const glm::ivec3& value) const;
  void set(const char* uniform, const glm::vec2& value) const;
  void set(const char* uniform, const glm::vec3& value) const;
  void set(const char* uniform, const glm::vec4& value) const;
  void set(const char* uniform, const glm::mat3& value) const;
  void set(const char* uniform, const glm::mat4& value) const;
  // Draws with the program in use. Clip space: low x, low y, high x, high y.
  void drawRectangle(const glm::vec4& rectangle) const;

 private:
  int location(const char* uniform) const;

  unsigned name_ = 0;
  unsigned vertex_array_ = 0;
};

// The first OpenGL error since the last call is GL_OUT_OF_MEMORY. Drops all others.
bool ranOutOfGlMemory();

}  // namespace kelp::render

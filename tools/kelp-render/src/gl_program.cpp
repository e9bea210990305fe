// SPDX-License-Identifier: MIT
#include "gl_program.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <string>
#include <vector>

#include <glm/gtc/type_ptr.hpp>

#include "glsl.h"
#include "kelp/common/error.h"

namespace kelp::render {
namespace {

constexpr char kDesktop[] = "#version 330 core\n";
constexpr char kEs[] =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
    "precision highp sampler3D;\nprecision highp usampler3D;\n";

[[noreturn]] void refuse(const char* what, const char* log) {
  throw ToolError(Exit::kRuntime, std::string("OpenGL does not ") + what + " a shader of kelp-render: " +
                                      log + "; please report this as a fault of kelp-render");
}

GLuint compile(GLenum kind, const std::vector<const char*>& strings) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, static_cast<GLsizei>(strings.size()), strings.data(), nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  char log[1000] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  refuse("compile", log);
}

}  // namespace

GlProgram::GlProgram(std::span<const char* const> fragment, bool es) {
  std::vector<const char*> fragment_strings{es ? kEs : kDesktop};
  fragment_strings.insert(fragment_strings.end(), fragment.begin(), fragment.end());
  const GLuint vertex_shader = compile(GL_VERTEX_SHADER, {es ? kEs : kDesktop, glsl::kRectangle}),
               fragment_shader = compile(GL_FRAGMENT_SHADER, fragment_strings);
  name_ = glCreateProgram();
  glAttachShader(name_, vertex_shader);
  glAttachShader(name_, fragment_shader);
  glLinkProgram(name_);
  glDeleteShader(vertex_shader);
  glDeleteShader(fragment_shader);
  GLint good = 0;
  glGetProgramiv(name_, GL_LINK_STATUS, &good);
  if (!good) {
    char log[1000] = "";
    glGetProgramInfoLog(name_, sizeof log, nullptr, log);
    refuse("link", log);
  }
  glGenVertexArrays(1, &vertex_array_);
}

GlProgram::~GlProgram() {
  glDeleteProgram(name_);
  glDeleteVertexArrays(1, &vertex_array_);
}

void GlProgram::use() const { glUseProgram(name_); }

int GlProgram::location(const char* uniform) const { return glGetUniformLocation(name_, uniform); }

void GlProgram::set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
void GlProgram::set(const char* uniform, float value) const { glUniform1f(location(uniform), value); }
void GlProgram::set(const char* uniform, const glm::ivec3& value) const {
  glUniform3i(location(uniform), value.x, value.y, value.z);
}
void GlProgram::set(const char* uniform, const glm::vec2& value) const {
  glUniform2f(location(uniform), value.x, value.y);
}
void GlProgram::set(const char* uniform, const glm::vec3& value) const {
  glUniform3f(location(uniform), value.x, value.y, value.z);
}
void GlProgram::set(const char* uniform, const glm::vec4& value) const {
  glUniform4f(location(uniform), value.x, value.y, value.z, value.w);
}
void GlProgram::set(const char* uniform, const glm::mat3& value) const {
  glUniformMatrix3fv(location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}
void GlProgram::set(const char* uniform, const glm::mat4& value) const {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}

void GlProgram::drawRectangle(const glm::vec4& rectangle) const {
  set("rectangle", rectangle);
  glBindVertexArray(vertex_array_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

bool ranOutOfGlMemory() {
  const bool out_of_memory = glGetError() == GL_OUT_OF_MEMORY;
  while (glGetError() != GL_NO_ERROR) continue;
  return out_of_memory;
}

}  // namespace kelp::render

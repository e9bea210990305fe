// SPDX-License-Identifier: MIT
#include "window/slice.h"

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <utility>
#include <vector>

#include "kelp/common/distance_slice.h"
#include "model.h"

namespace kelp::view {
namespace {

constexpr char kVersion[] = "#version 330 core\n";
constexpr char kScreen[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, "
    "1.0); }\n";

}  // namespace

Slice::~Slice() {
  if (program_ != 0) glDeleteProgram(program_);
  if (vertices_ != 0) glDeleteVertexArrays(1, &vertices_);
}

std::string Slice::build(const gl::Renderer& renderer) {
  std::vector<const char*> fragment{kVersion, "#define KELP_HOST_SURFACE\n"};
  fragment.insert(fragment.end(), renderer.traceGlsl().begin(), renderer.traceGlsl().end());
  fragment.push_back(kDistanceSlice);
  const std::vector<const char*> vertex{kVersion, kScreen};
  program_ = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
    const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
    glShaderSource(shader, static_cast<GLsizei>(text.size()), text.data(), nullptr);
    glCompileShader(shader);
    glAttachShader(program_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program_);
  GLint good = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &good);
  if (!good) return "OpenGL refuses the program that shows distances";
  glGenVertexArrays(1, &vertices_);
  return {};
}

std::string Slice::draw(gl::Renderer& renderer, const gl::View& view, const runtime::Instance& instance,
                        float distance) {
  if (vertices_ == 0) {
    if (std::string wrong = build(renderer); !wrong.empty()) return wrong;
  }
  if (const auto bound = renderer.bindTrace(program_, view, {&instance, 1}); !bound)
    return describe(bound.error());
  const DistanceSlice slice(view.camera.world_to_eye, view.camera.eye_to_clip, distance);
  const auto at = [this](const char* uniform) { return glGetUniformLocation(program_, uniform); };
  glUseProgram(program_);
  glUniformMatrix4fv(at("slice_clip_to_world"), 1, GL_FALSE, &slice.clip_to_world[0][0]);
  glUniform2f(at("slice_viewport"), static_cast<float>(view.camera.viewport.x),
              static_cast<float>(view.camera.viewport.y));
  glUniform1f(at("slice_at"), slice.at);
  glUniform1f(at("slice_contour"), slice.contour);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glUseProgram(0);
  return {};
}

}  // namespace kelp::view

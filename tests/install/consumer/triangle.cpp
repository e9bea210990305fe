// SPDX-License-Identifier: MIT
// draw.cpp's program without kelp: a triangle instead of a pack.
#include <cstdio>
#include <initializer_list>

#include "headless.h"

namespace {

const char* const kShaders[2] = {R"(#version 330 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 0.8 : -0.8, gl_VertexID == 2 ? 0.8 : -0.8, 0.0, 1.0); })",
                                 R"(#version 330 core
out vec4 color;
void main() { color = vec4(gl_FragCoord.xy / 128.0, 0.5, 1.0); })"};

GLuint compile() {
  const GLuint program = glCreateProgram();
  for (const int i : {0, 1}) {
    const GLuint shader = glCreateShader(i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &kShaders[i], nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  return program;
}

}  // namespace

int main() {
  if (!makeContext()) return 4;
  GLuint no_vertices = 0;
  glGenVertexArrays(1, &no_vertices);
  glBindVertexArray(no_vertices);
  glUseProgram(compile());
  for (int frame = 0; frame < 2; ++frame) {
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  const int colors = countColors();
  std::printf("%d colors\n", colors);
  destroyContext();
  return colors > 1 ? 0 : 4;
}

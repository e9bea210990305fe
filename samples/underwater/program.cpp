// SPDX-License-Identifier: MIT
#include "program.h"

#include <cstdio>
#include <initializer_list>

#include "glsl.h"

namespace underwater {

GLuint makeProgram(const char* name, const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  char words[1024] = "";
  for (const GLenum kind : {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER}) {
    const char* const text[] = {"#version 330 core\n", glsl::kWater,
                                kind == GL_VERTEX_SHADER ? vertex : fragment};
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 3, text, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (!good) glGetShaderInfoLog(shader, sizeof words, nullptr, words);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // as soon as the program is
  }
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good) return program;
  if (!words[0]) glGetProgramInfoLog(program, sizeof words, nullptr, words);
  std::fprintf(stderr, "underwater: the shaders of the %s do not compile: %s\n", name, words);
  glDeleteProgram(program);
  return 0;
}

}  // namespace underwater

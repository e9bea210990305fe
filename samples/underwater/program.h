// SPDX-License-Identifier: MIT
// OpenGL for the triangles of this scene: its header, and programs that know the water.
#pragma once

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

namespace underwater {

// A program of water.glsl and the two texts; what the compiler says goes to stderr, and then the answer is 0.
GLuint makeProgram(const char* name, const char* vertex, const char* fragment);

}  // namespace underwater

// SPDX-License-Identifier: MIT
// An OpenGL 3.3 core context without a window, and a framebuffer to draw into.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

constexpr int kSide = 128;  // pixels

// Makes a context current, with a bound framebuffer of kSide x kSide pixels of color and depth. On failure
// says why and answers false.
bool makeContext();
void destroyContext();
void* getProcAddress(void* user, const char* name);

// Reads the picture back: the number of different colors in it.
int countColors();

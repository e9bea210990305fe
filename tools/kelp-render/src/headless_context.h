// SPDX-License-Identifier: MIT
// An OpenGL context without a window: OpenGL 3.3 core, or OpenGL ES 3.0 where that is all there is.
#pragma once

#include <EGL/egl.h>

namespace kelp::render {

class HeadlessContext {
 public:
  // Current on this thread from here on. ToolError kRuntime where the machine has none.
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  bool es() const { return es_; }
  static void* getProcAddress(void* user, const char* name);

 private:
  bool makeCurrent(bool es);

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  bool es_ = false;
};

}  // namespace kelp::render

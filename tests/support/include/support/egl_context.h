// SPDX-License-Identifier: MIT
// A GL context without a window, for tests: EGL on Mesa's surfaceless platform, or on the default display.
// Link OpenGL::EGL; GL functions come from getProcAddress, or from OpenGL::OpenGL, which serves OpenGL ES contexts too.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <string>

namespace kelp::test {

enum class GlApi { kDesktop33, kEs30 };

inline std::string toString(GlApi api) { return api == GlApi::kEs30 ? "Es30" : "Desktop33"; }

// Current on the thread that made it, until it is destroyed. Test it before use: false where the machine has no such context.
class EglContext {
 public:
  explicit EglContext(GlApi api) {
    if (!openDisplay()) return;
    const bool es = api == GlApi::kEs30;
    eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0) return;
    const EGLint desktop[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, es ? embedded : desktop);
    current_ = context_ != EGL_NO_CONTEXT && eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }
  ~EglContext() {
    if (display_ == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  explicit operator bool() const { return current_; }

  // For kelp::gl::Config.
  static void* getProcAddress(void*, const char* name) { return reinterpret_cast<void*>(eglGetProcAddress(name)); }

 private:
  bool openDisplay() {
    display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr)) return true;
    display_ = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    return display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  bool current_ = false;
};

}  // namespace kelp::test

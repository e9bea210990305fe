// SPDX-License-Identifier: MIT
// A GL context without a window, for tests: EGL on Mesa's surfaceless platform, or on the default display.
// Link OpenGL::EGL; GL functions come from getProcAddress, or from OpenGL::OpenGL, which serves OpenGL ES
// contexts too.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <string>

namespace kelp::test {

// The least that is asked for; a driver may give a later version of the same API (test it with
// GL_MAJOR_VERSION).
enum class GlApi { kDesktop33, kDesktop45, kEs30, kEs32 };
inline constexpr GlApi kEveryApi[] = {GlApi::kDesktop33, GlApi::kDesktop45, GlApi::kEs30, GlApi::kEs32};

inline bool isEs(GlApi api) { return api == GlApi::kEs30 || api == GlApi::kEs32; }

inline std::string toString(GlApi api) {
  switch (api) {
    case GlApi::kDesktop33:
      return "Desktop33";
    case GlApi::kDesktop45:
      return "Desktop45";
    case GlApi::kEs30:
      return "Es30";
    default:
      return "Es32";
  }
}

// Current on the thread that made it, until another is made current there. Test it before use: false where
// the machine has no such context. Several may live at once; destroy each on a thread where it, or none, is
// current.
class EglContext {
 public:
  // `debug`: the driver tells KHR_debug all it can.
  explicit EglContext(GlApi api, bool debug = false) : es_(isEs(api)) {
    if (!openDisplay()) return;
    eglBindAPI(es_ ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                             es_ ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0) return;
    const EGLint minor = api == GlApi::kDesktop33   ? 3
                         : api == GlApi::kDesktop45 ? 5
                         : api == GlApi::kEs32      ? 2
                                                    : 0;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 api == GlApi::kDesktop45 ? 4 : 3,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 minor,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 debug ? EGL_TRUE : EGL_FALSE,
                                 es_ ? EGL_NONE : EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, attributes);
    good_ = makeCurrent();
  }
  ~EglContext() {
    if (context_ == EGL_NO_CONTEXT) return;
    eglBindAPI(es_ ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
    if (eglGetCurrentContext() == context_)
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  explicit operator bool() const { return good_; }

  // On this thread, in place of whichever context was.
  bool makeCurrent() const {
    if (context_ == EGL_NO_CONTEXT) return false;
    eglBindAPI(es_ ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
    return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }

  // For kelp::gl::RendererOptions.
  static void* getProcAddress(void*, const char* name) {
    return reinterpret_cast<void*>(eglGetProcAddress(name));
  }

 private:
  bool openDisplay() {
    display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr)) return true;
    display_ = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    return display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  bool es_ = false;
  bool good_ = false;
};

}  // namespace kelp::test

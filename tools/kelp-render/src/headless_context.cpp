// SPDX-License-Identifier: MIT
#include "headless_context.h"

#include <EGL/eglext.h>

#include "kelp/common/error.h"

namespace kelp::render {
namespace {

// A machine's GPU if it has one (devices come first to last), else Mesa's software, else whatever the
// environment offers.
EGLDisplay openDisplay() {
  const auto tryDisplay = [](EGLDisplay display) {
    return display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr);
  };
  const EGLDisplay surfaceless =
      eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (tryDisplay(surfaceless)) return surfaceless;
  const auto query = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  EGLDeviceEXT devices[8];
  EGLint count = 0;
  if (query && query(8, devices, &count)) {
    for (EGLint i = 0; i < count; ++i) {
      const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
      if (tryDisplay(display)) return display;
    }
  }
  const EGLDisplay any = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  return tryDisplay(any) ? any : EGL_NO_DISPLAY;
}

}  // namespace

HeadlessContext::HeadlessContext() : display_(openDisplay()) {
  if (display_ == EGL_NO_DISPLAY)
    throw ToolError(Exit::kRuntime, "no EGL device to draw with; install libegl1 libgl1-mesa-dri");
  if (makeCurrent(false) || makeCurrent(true)) return;
  eglTerminate(display_);
  throw ToolError(Exit::kRuntime,
                  "the EGL device offers neither OpenGL 3.3 nor OpenGL ES 3.0; install libegl1 "
                  "libgl1-mesa-dri, or update the driver");
}

HeadlessContext::~HeadlessContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

bool HeadlessContext::makeCurrent(bool es) {
  es_ = es;
  eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT,
                           EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0) return false;
  const EGLint desktop[] = {EGL_CONTEXT_MAJOR_VERSION,
                            3,
                            EGL_CONTEXT_MINOR_VERSION,
                            3,
                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                            EGL_NONE};
  const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, es ? embedded : desktop);
  if (context_ == EGL_NO_CONTEXT) return false;
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return true;
  eglDestroyContext(display_, context_);
  return false;
}

void* HeadlessContext::getProcAddress(void*, const char* name) {
  return reinterpret_cast<void*>(eglGetProcAddress(name));
}

}  // namespace kelp::render

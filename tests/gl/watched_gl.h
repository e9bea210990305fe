// SPDX-License-Identifier: MIT
// The context's own OpenGL, every call of which is counted.
#pragma once

namespace kelp::test {

struct WatchedGl {
  // For kelp::gl::RendererOptions; `user` is not used. Fails the test if kelp asks for a function that is not
  // in its table.
  static void* getProcAddress(void* user, const char* name);
  // Calls of any thread since the program began.
  static long calls();
  // This thread is one with a context.
  static void enterGlThread();
  // Calls of threads that are none.
  static long strayCalls();
};

}  // namespace kelp::test

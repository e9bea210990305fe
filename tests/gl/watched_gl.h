// SPDX-License-Identifier: MIT
// The context's own OpenGL, every call of which is counted.
#pragma once

namespace kelp::test {

struct WatchedGl {
  // For kelp::gl::Config; `user` is not used. Fails the test if kelp asks for a function that is not in its table.
  static void* getProcAddress(void* user, const char* name);
  // Calls of any thread since the program began.
  static long calls();
  // Those of threads that had no context current.
  static long strayCalls();
};

}  // namespace kelp::test

// SPDX-License-Identifier: MIT
// The GLSL programs of bench_trace.
#pragma once

#include <GL/glcorearb.h>

#include "bench_trace_gpu.h"

namespace kelp::bench {

// Needs a current context. Throws std::runtime_error with the log of what does not compile or link.
GLuint linkProgram(Method method, Bend bend);

}  // namespace kelp::bench

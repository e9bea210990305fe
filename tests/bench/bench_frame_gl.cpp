// SPDX-License-Identifier: MIT
#include "bench_frame_gl.h"

namespace kelp::bench {
void reportGl(Report&, int) {}
}

// SPDX-License-Identifier: MIT
// Views of kelp.h -> those of C++.
#pragma once

#include "kelp/c/renderer.h"
#include "kelp/gl/renderer.h"

namespace kelp::c {

kelp_result readView(const kelp_view* from, gl::View& to);

}  // namespace kelp::c

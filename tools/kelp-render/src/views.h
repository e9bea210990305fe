// SPDX-License-Identifier: MIT
// The meaning of the pixels of each --view.
#pragma once

#include <string>

#include "camera.h"
#include "options.h"

namespace kelp::render {

struct ViewStyle {
  std::string surface;  // GLSL for kelp::gl::RendererOptions::surface_glsl; empty: kelp's own look
  gl::DebugView debug = gl::DebugView::kNone;  // kelp's method then draws without `surface`
  bool colors = false;                         // linear color, to be encoded as sRGB; else plain numbers
  Background background;                       // unless --background says otherwise
};

ViewStyle styleOf(ViewKind kind, const Camera& camera);

}  // namespace kelp::render

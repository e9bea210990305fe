// SPDX-License-Identifier: MIT
// A picture of triangles, lit as kelp-render lights voxels.
#pragma once

#include "kelp/gl/renderer.h"
#include "pixels.h"

namespace kelp::sheet {

// `view`: camera and sun. Flat shading, base colour bilinear, four samples a pixel, no shadows.
Picture drawTriangles(const Scene& scene, const gl::View& view, int side, Rgb ground);

}  // namespace kelp::sheet

// SPDX-License-Identifier: MIT
// Pixels in memory, from the samples that were drawn to what goes into the file.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "options.h"

namespace kelp::render {

// RGBA, 8 bits each, rows from top to bottom.
struct Picture {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgba;
};

// `drawn`: `samples` * `samples` for each pixel, rows from bottom to top as OpenGL reads them, premultiplied, alpha 0 where nothing was drawn.
// `colors`: the values are sRGB colours, to be averaged as light; else plain numbers. Transparent backgrounds leave alpha as coverage.
Picture resolve(const std::vector<std::uint8_t>& drawn, glm::ivec2 size, int samples, bool colors, const Background& background);

}  // namespace kelp::render

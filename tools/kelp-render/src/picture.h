// SPDX-License-Identifier: MIT
// From the samples that were drawn to the pixels of the file.
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

// `drawn`: `samples` * `samples` values for each pixel, RGBA, premultiplied, rows from bottom to top; alpha 0
// where nothing was drawn. `colors`: the values are sRGB colours and are averaged as light; else plain
// numbers. With a transparent background alpha is the coverage.
Picture resolve(const std::vector<std::uint8_t>& drawn, glm::ivec2 size, int samples, bool colors,
                const Background& background);

}  // namespace kelp::render

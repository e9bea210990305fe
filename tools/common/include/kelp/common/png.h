// SPDX-License-Identifier: MIT
// Pictures as PNG files. In kelp::common_png, which exists where libpng was found.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "kelp/common/output_file.h"

namespace kelp {

// Writes 8-bit sRGB pixels, row by row from the top, to `file` and commits it. 4 channels: RGBA, alpha not
// premultiplied. 1 channel: gray. `pixels` holds size.x * size.y * channels bytes. ToolError kIo, or kRuntime
// if libpng fails.
void writePng(OutputFile&& file, const glm::ivec2& size, int channels, std::span<const std::uint8_t> pixels);

}  // namespace kelp

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/bake/source_model.h"

namespace kelp::bake {

// Whether the bytes begin as a PNG file does.
bool isPng(std::span<const std::uint8_t> bytes);

// Decodes a PNG picture of any kind to RGBA, the numbers as they are stored: of 16 bits the upper 8, and what the file says of its colours (gAMA, sRGB, iCCP) is not read. Safe for
// hostile input: its size is checked before memory is taken. The string says why not.
std::variant<Image, std::string> decodePng(std::span<const std::uint8_t> bytes, const std::string& name);

// By its header; 0 x 0 where that is none.
glm::ivec2 pngSize(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake

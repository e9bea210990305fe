// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Whether the bytes begin as a PNG file does.
bool isPng(std::span<const std::uint8_t> bytes);

// Decodes a PNG picture of any kind to RGBA, the numbers as they are stored. Of 16 bits the upper 8 are
// taken; gAMA, sRGB and iCCP are ignored. The string says why a picture cannot be read. Safe for hostile
// input: the size is checked before memory is taken.
std::variant<Image, std::string> decodePng(std::span<const std::uint8_t> bytes, const std::string& name);

// The size in its header; 0 x 0 if that is damaged.
glm::ivec2 pngSize(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake

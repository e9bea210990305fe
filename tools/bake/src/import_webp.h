// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/bake/source_model.h"

namespace kelp::bake {

// Whether the bytes begin as a WebP file does.
bool isWebp(std::span<const std::uint8_t> bytes);

// Decodes a still WebP picture, lossy or lossless, to RGBA. Safe for hostile input: its size is checked before memory is taken. The string
// says why not.
std::variant<Image, std::string> decodeWebp(std::span<const std::uint8_t> bytes, const std::string& name);

// By its header; 0 x 0 where that is none.
glm::ivec2 webpSize(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake

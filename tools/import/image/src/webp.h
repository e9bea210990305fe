// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Whether the bytes begin as a WebP file does.
bool isWebp(std::span<const std::uint8_t> bytes);

// Decodes a still WebP picture, lossy or lossless, to RGBA. The string says why a picture cannot be read.
// Safe for hostile input: the size is checked before memory is taken.
std::variant<Image, std::string> decodeWebp(std::span<const std::uint8_t> bytes, const std::string& name);

// The size in its header; 0 x 0 if that is damaged.
glm::ivec2 webpSize(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake

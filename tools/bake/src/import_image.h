// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/bake/source_model.h"

namespace kelp::bake {

// Decodes PNG, JPEG, WebP, BMP or TGA to RGBA. Safe for hostile input: sizes are checked before memory is taken. The string says why not.
std::variant<Image, std::string> decodeImage(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace kelp::bake

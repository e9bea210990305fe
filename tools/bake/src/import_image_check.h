// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace kelp::bake {

// What in a picture's bytes stb_image would take on trust, in words that follow the picture's name; nullptr if there is none. To be asked before stb_image is. Safe for hostile input.
const char* trustedFlaw(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake

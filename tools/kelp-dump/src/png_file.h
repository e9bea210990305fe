// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace kelp::dump {

// A PNG of 8-bit sRGB pixels, row by row from the top; 4 channels: with alpha, not premultiplied; 1: grey. DumpError (kFailure).
std::vector<std::byte> encodePng(const glm::ivec2& size, int channels, std::span<const std::uint8_t> pixels);

}  // namespace kelp::dump

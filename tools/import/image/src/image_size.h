// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

inline constexpr int kMaxPictureSide = 16384;

// Why a picture of this size is not read; nothing if it is. Decoders ask before they take memory.
inline std::optional<std::string> tooLarge(glm::ivec2 size) {
  constexpr std::int64_t kMaxPixels = std::int64_t{8192} * 8192;  // 256 MiB decoded
  if (size.x <= kMaxPictureSide && size.y <= kMaxPictureSide && std::int64_t{size.x} * size.y <= kMaxPixels)
    return std::nullopt;
  return "has " + std::to_string(size.x) + " x " + std::to_string(size.y) +
         " pixels; at most 8192 x 8192 are read, and 16384 in a row or a column";
}

// A picture of this size, which is not too large, with all bytes 0.
inline Image blankImage(const std::string& name, glm::ivec2 size) {
  Image image;
  image.name = name;
  image.width = size.x;
  image.height = size.y;
  image.rgba.resize(std::size_t{4} * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  return image;
}

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
// Pictures in and out, and letters on them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "second_loader.h"

namespace kelp::sheet {

using Rgb = glm::u8vec3;

// 8 bits a channel, row 0 at the top. `covered`: where a picture on a transparent ground shows something;
// empty for opaque ones.
struct Picture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
  std::vector<std::uint8_t> covered;

  Picture() = default;
  Picture(int w, int h, Rgb color)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), color) {}
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) + static_cast<std::size_t>(width) * static_cast<std::size_t>(y);
  }
  void paste(const Picture& other, int left, int top);
  // Letters are some 9 pixels high; what does not fit `most` pixels is left out.
  void write(std::string_view text, int left, int top, int most, Rgb color);
};

// PNG, JPEG, BMP or TGA.
std::optional<Texture> decodeTexture(const void* bytes, std::size_t size);
std::optional<Texture> readTexture(const std::filesystem::path& path);
std::optional<Picture> readPicture(const std::filesystem::path& path, Rgb ground);
bool writePng(const std::filesystem::path& path, const Picture& picture);

}  // namespace kelp::sheet

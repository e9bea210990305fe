// SPDX-License-Identifier: MIT
#include "pixels.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_easy_font.h>
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace kelp::sheet {
namespace {

struct Free {
  void operator()(unsigned char* p) const { stbi_image_free(p); }
};
using Bytes = std::unique_ptr<unsigned char, Free>;

}  // namespace

float linearFromSrgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

void Picture::paste(const Picture& other, int left, int top) {
  for (int y = 0; y < other.height && top + y < height; ++y) {
    for (int x = 0; x < other.width && left + x < width; ++x)
      pixels[index(left + x, top + y)] = other.pixels[other.index(x, y)];
  }
}

void Picture::write(std::string_view text, int left, int top, int most, Rgb color) {
  std::string line(text);
  for (char& c : line) c = c >= 32 && c < 127 ? c : '?';
  while (!line.empty() && stb_easy_font_width(line.data()) > most) line.pop_back();
  // Quads of four corners of 16 bytes (x, y, z as floats, a colour): axis-parallel rectangles of whole
  // pixels.
  std::vector<float> quads(line.size() * 300 / sizeof(float) + 64);
  const int count = stb_easy_font_print(0, 0, line.data(), nullptr, quads.data(),
                                        static_cast<int>(quads.size() * sizeof(float)));
  for (int q = 0; q < count; ++q) {
    const float* low = &quads[static_cast<std::size_t>(q) * 16];
    const float* high = low + 8;
    for (int y = static_cast<int>(low[1]); y < static_cast<int>(high[1]); ++y) {
      for (int x = static_cast<int>(low[0]); x < static_cast<int>(high[0]); ++x) {
        if (left + x < width && top + y < height) pixels[index(left + x, top + y)] = color;
      }
    }
  }
}

std::optional<Texture> decodeTexture(const void* bytes, std::size_t size) {
  Texture texture;
  int channels = 0;
  const Bytes data(stbi_load_from_memory(static_cast<const unsigned char*>(bytes), static_cast<int>(size),
                                         &texture.width, &texture.height, &channels, 4));
  if (!data) return std::nullopt;
  const std::size_t count =
      static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  texture.texels.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto channel = [&](std::size_t c) { return static_cast<float>(data.get()[4 * i + c]) / 255.0f; };
    texture.texels.emplace_back(linearFromSrgb(channel(0)), linearFromSrgb(channel(1)),
                                linearFromSrgb(channel(2)), channel(3));
  }
  return texture;
}

std::optional<Texture> readTexture(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  return bytes.empty() ? std::nullopt : decodeTexture(bytes.data(), bytes.size());
}

std::optional<Picture> readPicture(const std::filesystem::path& path, Rgb ground) {
  int width = 0, height = 0, channels = 0;
  const Bytes data(stbi_load(path.c_str(), &width, &height, &channels, 4));
  if (!data) return std::nullopt;
  Picture picture(width, height, ground);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const unsigned char* rgba = data.get() + 4 * i;
    picture.covered.push_back(rgba[3] >= 128 ? 1 : 0);
    for (int c = 0; c < 3; ++c) {
      picture.pixels[i][c] =
          static_cast<std::uint8_t>((rgba[c] * rgba[3] + ground[c] * (255 - rgba[3]) + 127) / 255);
    }
  }
  return picture;
}

bool writePng(const std::filesystem::path& path, const Picture& picture) {
  return stbi_write_png(path.c_str(), picture.width, picture.height, 3, picture.pixels.data(),
                        3 * picture.width) != 0;
}

}  // namespace kelp::sheet

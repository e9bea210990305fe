// SPDX-License-Identifier: MIT
#include "png_file.h"

#include <fmt/format.h>
#include <png.h>

#include "commands.h"

namespace kelp::dump {

std::vector<std::byte> encodePng(const glm::ivec2& size, int channels, std::span<const std::uint8_t> pixels) {
  png_image image{};  // libpng's simplified interface reports errors as values
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(size.x);
  image.height = static_cast<png_uint_32>(size.y);
  image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_GRAY;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> out(bytes);
  if (!png_image_write_to_memory(&image, out.data(), &bytes, 0, pixels.data(), 0, nullptr))
    throw DumpError(kFailure, fmt::format("libpng: {}; please report this as a fault of kelp-dump", image.message));
  out.resize(bytes);
  return out;
}

}  // namespace kelp::dump

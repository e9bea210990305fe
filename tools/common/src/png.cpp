// SPDX-License-Identifier: MIT
#include "kelp/common/png.h"

#include <cstddef>
#include <string>
#include <vector>

#include <png.h>

#include "kelp/common/error.h"

namespace kelp {

void writePng(OutputFile&& file, const glm::ivec2& size, int channels, std::span<const std::uint8_t> pixels) {
  png_image image{};  // libpng's simplified interface returns errors as values
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(size.x);
  image.height = static_cast<png_uint_32>(size.y);
  image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_GRAY;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> encoded(bytes);
  if (!png_image_write_to_memory(&image, encoded.data(), &bytes, 0, pixels.data(), 0, nullptr))
    throw ToolError(Exit::kRuntime,
                    std::string("libpng: ") + image.message + "; please report this as a fault of kelp");
  file.write(std::span(encoded).first(bytes));
  file.commit();
}

}  // namespace kelp

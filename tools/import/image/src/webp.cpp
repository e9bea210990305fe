// SPDX-License-Identifier: MIT
#include "codecs.h"

#include <cstring>

#include <webp/decode.h>

namespace kelp::bake {

// RFC 9649, section 2.4: "RIFF", the size, "WEBP".
bool isWebp(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

std::variant<Image, std::string> decodeWebp(std::span<const std::uint8_t> bytes, const std::string& name) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
    return std::string("is a WebP picture whose header is damaged or cut off");
  if (features.has_animation) return std::string("is an animated WebP picture; export a still one");
  if (auto reason = tooLarge({features.width, features.height})) return *std::move(reason);
  Image image = blankImage(name, {features.width, features.height});
  if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.rgba.data(), image.rgba.size(), 4 * image.width))
    return std::string("is a WebP picture that cannot be decoded; its data are damaged or cut off");
  return image;
}

glm::ivec2 webpSize(std::span<const std::uint8_t> bytes) {
  int width = 0, height = 0;
  return WebPGetInfo(bytes.data(), bytes.size(), &width, &height) ? glm::ivec2(width, height) : glm::ivec2(0);
}

}  // namespace kelp::bake

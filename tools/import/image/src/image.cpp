// SPDX-License-Identifier: MIT
#include "kelp/import/image/image.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

// Only the formats that no other library here decodes. stb_image's other decoders would be needless attack
// surface.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STBI_MALLOC(size) kelp::bake::stbAllocate(size)
#define STBI_REALLOC(memory, size) nullptr  // no decoder that is left uses it
#define STBI_FREE(memory) std::free(memory)

namespace kelp::bake {
namespace {

// If a file leaves out data, the library reads memory that it never wrote. So its memory begins as zeros, and
// a file bakes to the same bytes every time. The library also believes the sizes that a file claims, so an
// allocation larger than `most_bytes`, the most that the picture can need, fails.
constexpr std::size_t kHeadBytes = std::size_t{1} << 20;  // more than a palette
thread_local std::size_t most_bytes = kHeadBytes;
void* stbAllocate(std::size_t size) { return size <= most_bytes ? std::calloc(1, size) : nullptr; }

}  // namespace
}  // namespace kelp::bake

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "codecs.h"
#include "kelp/common/memory.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kMostBytes = 0x7fffffff;  // of a file: the libraries count in ints

glm::ivec2 stbSize(std::span<const std::uint8_t> bytes) {
  int width = 0, height = 0, channels = 0;
  return stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels)
             ? glm::ivec2(width, height)
             : glm::ivec2(0);
}

// BMP and TGA.
std::variant<Image, std::string> decodeStb(std::span<const std::uint8_t> bytes, const std::string& name) {
  glm::ivec2 size = stbSize(bytes);
  if (size.x <= 0 || size.y <= 0) return std::string("is not a PNG, JPEG, WebP, BMP or TGA image");
  if (auto reason = tooLarge(size)) return *std::move(reason);
  const std::size_t rgba_bytes =
      std::size_t{4} * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  int channels = 0;
  most_bytes = kHeadBytes + rgba_bytes;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &size.x, &size.y, &channels, 4),
      stbi_image_free);
  most_bytes = kHeadBytes;
  const char* failure = stbi_failure_reason();
  const std::string reason = failure && *failure ? failure : "its data are damaged or cut off";
  if (!pixels) return std::string("cannot be decoded (") + reason + ")";
  Image image = blankImage(name, size);
  std::copy_n(pixels.get(), rgba_bytes, image.rgba.begin());
  return image;
}

}  // namespace

std::variant<Image, std::string> decodeImage(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) return std::string("is empty");
  if (bytes.size() > kMostBytes) return std::string("is larger than 2 GiB");
  if (isPng(bytes)) return decodePng(bytes, name);
  if (isJpeg(bytes)) return decodeJpeg(bytes, name);
  if (isWebp(bytes)) return decodeWebp(bytes, name);
  constexpr std::string_view kKtx2 = "\xabKTX 20\xbb\r\n\x1a\n";
  if (bytes.size() >= kKtx2.size() && std::memcmp(bytes.data(), kKtx2.data(), kKtx2.size()) == 0)
    return std::string("is a KTX2 texture, which kelp does not read; export it as PNG, JPEG or WebP");
  return decodeStb(bytes, name);
}

glm::ivec2 imageSize(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMostBytes) return glm::ivec2(0);
  const glm::ivec2 size = isPng(bytes)    ? pngSize(bytes)
                          : isJpeg(bytes) ? jpegSize(bytes)
                          : isWebp(bytes) ? webpSize(bytes)
                                          : stbSize(bytes);
  return size.x > 0 && size.y > 0 && !tooLarge(size) ? size : glm::ivec2(0);
}

void PictureBudget::take(glm::ivec2 size, const std::string& place) {
  constexpr std::uint64_t kTexelBytes = 10;  // RGBA, and a third as many texels of four floats: 4 + 16/3
  const std::uint64_t bytes =
      kTexelBytes * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
  if (const std::uint64_t most = memoryAllowed(files_, max_memory_, kUsual, kPerByteRead);
      bytes > most || taken_ > most - bytes)
    refuse(Exit::kRuntime, files_.input(), place,
           "with its " + std::to_string(size.x) + " x " + std::to_string(size.y) +
               " pixels, the model's pictures need more than " + printBytes(most) +
               " of memory; scale them down, or give a larger --max-memory");
  taken_ += bytes;
}

}  // namespace kelp::bake

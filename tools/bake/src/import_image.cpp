// SPDX-License-Identifier: MIT
#include "import_image.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

// Only the formats that glTF and MTL files use: stb_image's other decoders are attack surface without a purpose here.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STBI_MALLOC(size) kelp::bake::stbAllocate(size)
#define STBI_REALLOC(memory, size) kelp::bake::stbReallocate(memory, size)
#define STBI_FREE(memory) std::free(memory)

namespace kelp::bake {
namespace {

// The library reads what it has not written, where a file leaves out tables or data: its memory begins as zeros, so that a file bakes to the same bytes every time. And it
// takes what a file claims: a length of gigabytes, or data that inflate to them. `most_bytes`: of one allocation, by what the picture can need; beyond, it fails.
constexpr std::size_t kHeadBytes = std::size_t{4} << 20;  // more than the library's own tables, and the slack of a narrow JPEG
thread_local std::size_t most_bytes = kHeadBytes;
void* stbAllocate(std::size_t size) { return size <= most_bytes ? std::calloc(1, size) : nullptr; }
void* stbReallocate(void* memory, std::size_t size) { return size <= most_bytes ? std::realloc(memory, size) : nullptr; }

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

#include "import_image_check.h"
#include "import_webp.h"
#include "memory_estimate.h"

namespace kelp::bake {
namespace {
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;  // 8192 x 8192: 256 MiB decoded
}

std::variant<Image, std::string> decodeImage(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) return std::string("is empty");
  if (bytes.size() > 0x7fffffffu) return std::string("is larger than 2 GiB");
  const int length = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (isWebp(bytes)) return decodeWebp(bytes, name, kMaxPixels);
  constexpr std::string_view kKtx2 = "\xabKTX 20\xbb\r\n\x1a\n";
  if (bytes.size() >= kKtx2.size() && std::memcmp(bytes.data(), kKtx2.data(), kKtx2.size()) == 0) return std::string("is a KTX2 texture, which kelp does not read; export it as PNG, JPEG or WebP");
  if (const char* flaw = trustedFlaw(bytes)) return std::string(flaw) + "; its data are damaged";
  if (!stbi_info_from_memory(bytes.data(), length, &width, &height, &channels)) return std::string("is not a PNG, JPEG, WebP, BMP or TGA image");
  if (width <= 0 || height <= 0 || std::int64_t{width} * height > kMaxPixels)
    return "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels; at most 8192 x 8192 are read";
  // Four channels of 16 bits, and twice that while they are inflated; twice the file, which the library gathers by doubling.
  most_bytes = kHeadBytes + 16 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 2 * bytes.size();
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(stbi_load_from_memory(bytes.data(), length, &width, &height, &channels, 4), stbi_image_free);
  most_bytes = kHeadBytes;
  const char* failure = stbi_failure_reason();
  const std::string reason = failure && *failure ? failure : "its data are damaged or cut off";
  if (!pixels) return std::string("can not be decoded (") + reason + ")";
  Image image;
  image.name = name;
  image.width = width;
  image.height = height;
  image.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return image;
}

glm::ivec2 imageSize(std::span<const std::uint8_t> bytes) {
  int width = 0, height = 0, channels = 0;
  if (bytes.size() > 0x7fffffffu) return glm::ivec2(0);
  glm::ivec2 size(0);
  if (isWebp(bytes)) size = webpSize(bytes);
  else if (!trustedFlaw(bytes) && stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels)) size = {width, height};
  return size.x > 0 && size.y > 0 && std::int64_t{size.x} * size.y <= kMaxPixels ? size : glm::ivec2(0);
}

std::uint64_t PictureBudget::limit() const {
  return max_memory_ > 0 ? max_memory_ : std::min(physicalMemory(), kUsual + kPerByteRead * files_.bytesRead());
}

void PictureBudget::take(glm::ivec2 size, const std::string& place) {
  constexpr std::uint64_t kTexelBytes = 10;  // RGBA, and a third as many texels of four floats: 4 + 16/3
  const std::uint64_t bytes = kTexelBytes * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
  if (const std::uint64_t most = limit(); bytes > most || taken_ > most - bytes)
    refuse(Exit::kRuntime, files_.input(), place,
           "with its " + std::to_string(size.x) + " x " + std::to_string(size.y) + " pixels, the model's pictures need more than " + printBytes(most) +
               " of memory; scale them down, or give a larger --max-memory");
  taken_ += bytes;
}

}  // namespace kelp::bake

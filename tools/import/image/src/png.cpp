// SPDX-License-Identifier: MIT
#include "codecs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <string_view>

#include <png.h>

namespace kelp::bake {
namespace {

class PngReader : public JumpCatcher {
 public:
  explicit PngReader(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  // Reads everything before the pixels. False: reason() says why; likewise of read().
  bool begin() {
    return caught([&] { readHead(); });
  }
  // Writes four bytes a pixel, for as many pixels as pngSize says.
  bool read(std::uint8_t* rgba) {
    return caught([&] { readPixels(rgba); });
  }

 private:
  void readHead() {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, onError, onWarning);
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) fail("out of memory");
    png_set_read_fn(png_, this, onRead);
    png_set_user_limits(png_, kMaxPictureSide, kMaxPictureSide);
    // Skip what no pixel needs: text, profiles, gamma.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png_, info_);
  }

  void readPixels(std::uint8_t* rgba) {
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    const png_uint_32 width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    const std::size_t row = std::size_t{4} * width;
    if (png_get_rowbytes(png_, info_) != row) fail("its rows have an unknown length");
    for (int pass = 0; pass < passes; ++pass)
      for (png_uint_32 y = 0; y < height; ++y) png_read_row(png_, rgba + row * y, nullptr);
    png_read_end(png_, nullptr);
  }

  [[noreturn]] static void onError(png_structp png, png_const_charp message) {
    static_cast<PngReader*>(png_get_error_ptr(png))->fail(message);
  }
  // Without its transparency a picture looks different. All other warnings are about data that no pixel
  // needs.
  static void onWarning(png_structp png, png_const_charp message) {
    if (std::string_view(message).substr(0, 4) == "tRNS") onError(png, message);
  }
  static void onRead(png_structp png, png_bytep to, std::size_t size) {
    PngReader& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (size > reader.left_.size()) reader.fail("the file ends too early");
    std::memcpy(to, reader.left_.data(), size);
    reader.left_ = reader.left_.subspan(size);
  }

  std::span<const std::uint8_t> left_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

}  // namespace

bool isPng(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), bytes.begin());
}

std::variant<Image, std::string> decodePng(std::span<const std::uint8_t> bytes, const std::string& name) {
  const glm::ivec2 size = pngSize(bytes);
  if (size.x <= 0 || size.y <= 0) return std::string("is a PNG picture whose header is damaged or cut off");
  if (auto reason = tooLarge(size)) return *std::move(reason);
  PngReader reader(bytes);
  if (reader.begin()) {
    Image image = blankImage(name, size);
    if (reader.read(image.rgba.data())) return image;
  }
  return std::string("is a PNG picture that cannot be decoded (") + reader.reason() + ")";
}

// PNG, sections 5.3 and 11.2.2: after the signature a chunk's length, its name, width, height.
glm::ivec2 pngSize(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kHeader("\0\0\0\x0dIHDR", 8);
  if (bytes.size() < 24 || !isPng(bytes) ||
      std::memcmp(bytes.data() + 8, kHeader.data(), kHeader.size()) != 0)
    return glm::ivec2(0);
  const auto number = [&](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
           std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
  };
  return glm::ivec2(glm::uvec2(number(16), number(20)));
}

}  // namespace kelp::bake

// SPDX-License-Identifier: MIT
#include "codecs.h"

#include <cstddef>
#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>

namespace kelp::bake {
namespace {

// programs write a dozen; a few bytes can make each of them walk the whole picture
constexpr int kMaxScans = 100;

class JpegReader : public JumpCatcher {
 public:
  explicit JpegReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  ~JpegReader() { jpeg_destroy_decompress(&jpeg_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  // Reads everything before the pixels. False: reason() says why; likewise of read().
  bool begin() {
    return caught([&] { readHead(); });
  }
  glm::ivec2 size() const { return glm::ivec2(glm::uvec2(jpeg_.image_width, jpeg_.image_height)); }
  // Writes four bytes a pixel.
  bool read(std::uint8_t* rgba) {
    return caught([&] { readPixels(rgba); });
  }

 private:
  void readHead() {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = onError;
    errors_.emit_message = onMessage;
    jpeg_.client_data = this;
    jpeg_create_decompress(&jpeg_);
    jpeg_mem_src(&jpeg_, bytes_.data(), static_cast<unsigned long>(bytes_.size()));
    jpeg_read_header(&jpeg_, TRUE);
  }

  void readPixels(std::uint8_t* rgba) {
    const bool inks = jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK;
    jpeg_.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
    // The same bytes on every machine: with these settings the library's code for each processor gives the
    // same as its plain code.
    jpeg_.dct_method = JDCT_ISLOW;
    jpeg_.do_fancy_upsampling = TRUE;
    jpeg_.do_block_smoothing = FALSE;  // no guesses at coefficients that the data leave out
    progress_.progress_monitor = onProgress;
    jpeg_.progress = &progress_;
    // All coefficients of four components in two bytes each, in whole blocks. Beyond that the library fails,
    // because it is built without temporary files.
    constexpr long kTables = 8L << 20, kMostBlock = 32;
    jpeg_.mem->max_memory_to_use = kTables + 8 * (static_cast<long>(jpeg_.image_width) + kMostBlock) *
                                                 (static_cast<long>(jpeg_.image_height) + kMostBlock);
    jpeg_start_decompress(&jpeg_);
    if (jpeg_.output_components != 4) fail("its pixels have an unknown length");
    const std::size_t row = std::size_t{4} * jpeg_.output_width;
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW pixels = rgba + row * jpeg_.output_scanline;
      jpeg_read_scanlines(&jpeg_, &pixels, 1);
      if (inks) printInks(pixels, row);
    }
    jpeg_finish_decompress(&jpeg_);
  }

  // Adobe stores inks inverted (the light that an ink leaves), and other programs do the same.
  static void printInks(std::uint8_t* pixels, std::size_t bytes) {
    for (std::uint8_t* pixel = pixels; pixel < pixels + bytes; pixel += 4) {
      for (int i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>((pixel[i] * pixel[3] + 127) / 255);
      pixel[3] = 255;
    }
  }

  [[noreturn]] static void onError(j_common_ptr jpeg) {
    char reason[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, reason);
    static_cast<JpegReader*>(jpeg->client_data)->fail(reason);
  }
  // Levels below 0 are warnings, after which the library would go on with invented pixels. Programs and
  // cameras cause some that change no pixel.
  static void onMessage(j_common_ptr jpeg, int level) {
    if (level >= 0) return;
    switch (jpeg->err->msg_code) {
      case JWRN_EXTRANEOUS_DATA:  // padding before a marker
      case JWRN_NOT_SEQUENTIAL:   // a baseline scan that names other coefficients
      case JWRN_JFIF_MAJOR:
      case JWRN_ADOBE_XFORM:
        return;
      default:
        onError(jpeg);
    }
  }
  static void onProgress(j_common_ptr jpeg) {
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > kMaxScans)
      static_cast<JpegReader*>(jpeg->client_data)->fail("it has more than 100 scans");
  }

  std::span<const std::uint8_t> bytes_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
};

}  // namespace

// ITU T.81, annex B: the marker that starts an image.
bool isJpeg(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == 0xff && bytes[1] == 0xd8;
}

std::variant<Image, std::string> decodeJpeg(std::span<const std::uint8_t> bytes, const std::string& name) {
  JpegReader reader(bytes);
  if (reader.begin()) {
    if (auto reason = tooLarge(reader.size())) return *std::move(reason);
    Image image = blankImage(name, reader.size());
    if (reader.read(image.rgba.data())) return image;
  }
  return std::string("is a JPEG picture that cannot be decoded (") + reader.reason() + ")";
}

glm::ivec2 jpegSize(std::span<const std::uint8_t> bytes) {
  JpegReader reader(bytes);
  return reader.begin() ? reader.size() : glm::ivec2(0);
}

}  // namespace kelp::bake

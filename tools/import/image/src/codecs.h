// SPDX-License-Identifier: MIT
// One decoder for each format, and what they share. All are safe for hostile input: sizes are checked before
// memory is taken.
#pragma once

#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// is...(): true if the bytes begin as such a file does. decode...(): RGBA, or the reason why a picture cannot
// be read. ...Size(): from the header; 0 x 0 if that is damaged.

// PNG of any kind, the numbers as they are stored. Of 16 bits the upper 8 are taken; gAMA, sRGB and iCCP are
// ignored.
bool isPng(std::span<const std::uint8_t> bytes);
std::variant<Image, std::string> decodePng(std::span<const std::uint8_t> bytes, const std::string& name);
glm::ivec2 pngSize(std::span<const std::uint8_t> bytes);

// JPEG, baseline or progressive: gray, YCbCr, RGB, and CMYK as Adobe stores it. Profiles and orientation are
// ignored.
bool isJpeg(std::span<const std::uint8_t> bytes);
std::variant<Image, std::string> decodeJpeg(std::span<const std::uint8_t> bytes, const std::string& name);
glm::ivec2 jpegSize(std::span<const std::uint8_t> bytes);

// Still WebP, lossy or lossless.
bool isWebp(std::span<const std::uint8_t> bytes);
std::variant<Image, std::string> decodeWebp(std::span<const std::uint8_t> bytes, const std::string& name);
glm::ivec2 webpSize(std::span<const std::uint8_t> bytes);

inline constexpr int kMaxPictureSide = 16384;

// The reason why a picture of this size is not read; nothing if it is.
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

// The base of readers over C libraries that report an error by a longjmp. A longjmp runs no destructors, so
// code between caught() and the library's jump must own nothing.
class JumpCatcher {
 public:
  const char* reason() const { return reason_; }

 protected:
  // Runs work(). False if it jumped out: reason() says why.
  template <class Work>
  bool caught(const Work& work) {
    if (setjmp(out_)) return false;
    work();
    return true;
  }
  [[noreturn]] void fail(const char* reason) {
    std::snprintf(reason_, sizeof reason_, "%s", reason);
    std::longjmp(out_, 1);
  }

 private:
  std::jmp_buf out_;
  char reason_[200] = "";
};

}  // namespace kelp::bake

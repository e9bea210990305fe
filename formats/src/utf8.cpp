// SPDX-License-Identifier: MIT
#include <cstdint>

#include "metadata.h"

namespace kelp {
namespace {

// Removes one code point from the front. False if it is not valid.
bool takeCodePoint(std::string_view& text, std::uint32_t& code) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const std::uint32_t first = byte(0);
  // The length; then the bits that the first byte contributes, and the smallest code of this length.
  const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  static constexpr std::uint32_t kMask[5] = {0, 0x7F, 0x1F, 0x0F, 0x07};
  static constexpr std::uint32_t kLeast[5] = {0, 0, 0x80, 0x800, 0x10000};
  if ((first >= 0x80 && first < 0xC0) || first >= 0xF8 || text.size() < length) return false;
  code = first & kMask[length];
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return false;
    code = (code << 6) | (byte(i) & 0x3F);
  }
  text.remove_prefix(length);
  return code >= kLeast[length] && code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
}

}  // namespace

bool isUtf8(std::string_view text) {
  std::uint32_t code = 0;
  while (!text.empty()) {
    if (!takeCodePoint(text, code) || code == 0) return false;
  }
  return true;
}

bool isName(std::string_view text) {
  std::uint32_t code = 0;
  while (!text.empty()) {
    // Control characters C0, DEL and C1: a name must not control the terminal that prints it.
    if (!takeCodePoint(text, code) || code < 0x20 || (code >= 0x7F && code < 0xA0)) return false;
  }
  return true;
}

}  // namespace kelp

// SPDX-License-Identifier: MIT
#include "text/text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/error.h"
#include "kelp/common/srgb.h"

namespace kelp::dump {
std::string bytesText(std::uint64_t bytes) {
  static constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  double amount = static_cast<double>(bytes);
  int unit = 0;
  while (amount >= 1024 && unit < 4) {
    amount /= 1024;
    ++unit;
  }
  return unit == 0 ? fmt::format("{} bytes", bytes)
                   : fmt::format("{:.{}f} {}", amount,
                                 amount < 10    ? 2
                                 : amount < 100 ? 1
                                                : 0,
                                 kUnits[unit]);
}

std::string countText(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ' ');
  return digits;
}

std::string sizeText(const glm::ivec3& size) { return fmt::format("{} x {} x {}", size.x, size.y, size.z); }

std::string metersText(double meters) {
  const double size = std::abs(meters);
  if (size > 0 && size < 1e-3) return fmt::format("{:.3g} um", meters * 1e6);
  if (size < 1) return fmt::format("{:.3g} mm", meters * 1e3);
  return fmt::format("{:.4g} m", meters);
}

std::string nameText(std::string_view text, std::size_t longest) {
  std::string clean;
  for (std::size_t i = 0; i < text.size() && clean.size() < longest; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // U+0080 to U+009F are control characters too, C2 80 to C2 9F in UTF-8.
    const bool c1 = byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
    clean += byte < 0x20 || byte == 0x7f || c1 ? '?' : text[i];
    if (c1) ++i;
  }
  if (clean.size() < text.size() && clean.size() >= longest) {
    // Cut between two characters.
    while (!clean.empty() && (static_cast<unsigned char>(clean.back()) & 0xc0) == 0x80) clean.pop_back();
    if (!clean.empty() && static_cast<unsigned char>(clean.back()) >= 0xc0) clean.pop_back();
    clean += "...";
  }
  return clean;
}

std::string fourccText(std::uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const auto c = static_cast<char>((fourcc >> (8 * i)) & 0xff);
    text += c >= 0x20 && c < 0x7f ? c : '?';
  }
  return text;
}

std::string plural(std::uint64_t count, std::string_view word) {
  return fmt::format("{} {}{}", countText(count), word, count == 1 ? "" : "s");
}

std::string hexColor(const glm::vec4& linear) {
  return fmt::format("#{:02x}{:02x}{:02x}", linearToSrgb8(linear.r), linearToSrgb8(linear.g),
                     linearToSrgb8(linear.b));
}

std::string padRight(const std::string& text, std::size_t columns) {
  const auto width = static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
  return text + std::string(columns > width ? columns - width : 0, ' ');
}

void print(std::string_view text) {
  if (const std::string problem = console::writeOut(text); !problem.empty())
    throw ToolError(
        Exit::kIo,
        fmt::format("standard output cannot be written: {}; free space or choose another file", problem));
}

}  // namespace kelp::dump

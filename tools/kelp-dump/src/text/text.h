// SPDX-License-Identifier: MIT
// Text for people: sizes, names from files made safe for a terminal.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/formats/model.h"

namespace kelp::dump {

// "1.25 MiB", "832 bytes".
std::string bytesText(std::uint64_t bytes);
// "12 345".
std::string countText(std::uint64_t count);
// "64 x 256 x 48".
std::string sizeText(const glm::ivec3& size);
// A length in meters with a unit that suits it: "3.91 mm", "1.2 m".
std::string metersText(double meters);
// Text from a pack, safe for a terminal: control characters become '?'. Cut to `longest` bytes.
std::string nameText(std::string_view text, std::size_t longest = 120);
// A fourcc as four letters.
std::string fourccText(std::uint32_t fourcc);
// "1 clip", "2 clips".
std::string plural(std::uint64_t count, std::string_view word);
// A linear color as "#rrggbb" in sRGB.
std::string hexColor(const glm::vec4& linear);
// Adds spaces up to that many columns, counting characters, not bytes. Longer text stays unchanged.
std::string padRight(const std::string& text, std::size_t columns);

// One line to stderr that begins with the program's name. Line breaks in quoted names become spaces. Errors
// of writing are ignored.
template <class... Arguments>
void say(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  std::fputs(
      ("kelp-dump: " + console::oneLine(fmt::format(format, std::forward<Arguments>(arguments)...)) + "\n")
          .c_str(),
      stderr);
}

// Writes all of `text` to stdout; ToolError kIo if that fails.
void print(std::string_view text);

}  // namespace kelp::dump

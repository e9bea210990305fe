// SPDX-License-Identifier: MIT
#include <algorithm>

#include "kelp/common/console.h"

namespace kelp::console {
namespace {

// U+0080 to U+009F: C2 80 to C2 9F in UTF-8.
bool isC1(std::string_view text, std::size_t i) {
  return i + 1 < text.size() && text[i] == '\xc2' && static_cast<unsigned char>(text[i + 1]) >= 0x80 &&
         static_cast<unsigned char>(text[i + 1]) < 0xa0;
}

}  // namespace

std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  for (std::size_t i = 0; i < text.size(); ++i)
    if (isC1(text, i)) text[i] = text[i + 1] = ' ';
  return text;
}

std::string escapeControls(std::string_view json) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  out.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    const bool c1 = isC1(json, i);
    if (!c1 && json[i] != '\x7f') {
      out += json[i];
      continue;
    }
    const auto code = static_cast<unsigned char>(json[c1 ? ++i : i]);
    out += {'\\', 'u', '0', '0', kDigits[code >> 4], kDigits[code & 15]};
  }
  return out;
}

}  // namespace kelp::console

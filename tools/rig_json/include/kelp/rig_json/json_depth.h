// SPDX-License-Identifier: MIT
// How deeply JSON is nested, before anything is built from it: what builds values, prints and destroys them recurses. The library's own callback, asked at every value, goes through
// all that an array has so far at the end of each object in it.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace kelp {

// The byte of the first bracket within more than `most` that are open; nothing where no text goes so deep. Of text that is no JSON, any answer.
inline std::optional<std::size_t> nestedDeeper(std::string_view text, int most) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      i += c == '\\' ? 1 : 0;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > most) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return {};
}

}  // namespace kelp

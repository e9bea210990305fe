// SPDX-License-Identifier: MIT
// How deeply JSON is nested and how many members its objects have, before anything is built from it: what builds values, prints and destroys them recurses, and looks for keys one by
// one. The library's own callback, asked at every value, goes through all that an array has so far at the end of each object in it.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

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

// Whether an object has more than `most` members, or all of them so many that finding each among those before it would take longer than in four objects of `most` members. Of text that
// is no JSON, any answer.
inline bool hasLargerObjects(std::string_view text, std::size_t most) {
  std::vector<std::size_t> members;  // of each bracket that is open
  std::size_t compared = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      i += c == '\\' ? 1 : 0;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      members.push_back(0);
    } else if ((c == ']' || c == '}') && !members.empty()) {
      members.pop_back();
    } else if (c == ':' && !members.empty()) {
      compared += members.back()++;
      if (members.back() > most || compared > 2 * most * most) return true;
    }
  }
  return false;
}

}  // namespace kelp

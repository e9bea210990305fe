// SPDX-License-Identifier: MIT
// Measures how deeply JSON is nested and how many members its objects have, before it is parsed: the library
// builds, prints and destroys values recursively, and searches keys one by one. Its own callback cannot do
// this: at the end of each object it goes through the whole array so far.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace kelp {

// The byte of the first bracket that is nested more than `most` deep; nullopt if there is none. Any answer
// for text that is not JSON.
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

// True if an object has more than `most` members, or if finding each key of all objects among those before it
// would take longer than in four objects of `most` members. Any answer for text that is not JSON.
inline bool hasLargerObjects(std::string_view text, std::size_t most) {
  std::vector<std::size_t> members;  // for each open bracket
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

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace kelp::bake {

// Joins equal notices of several parts into one.
class PartNotices {
 public:
  void add(const std::string& part, const std::string& text) {
    const auto said = std::find_if(said_.begin(), said_.end(), [&](const Said& s) { return s.text == text; });
    if (said == said_.end())
      said_.push_back({text, part, 1});
    else
      ++said->parts;
  }
  void moveTo(std::vector<std::string>& notices) const {
    for (const Said& s : said_)
      notices.push_back(s.parts == 1
                            ? fmt::format("part '{}': {}", s.first, s.text)
                            : fmt::format("part '{}' and {} more: {}", s.first, s.parts - 1, s.text));
  }

 private:
  struct Said {
    std::string text, first;
    std::size_t parts = 0;
  };
  std::vector<Said> said_;
};

}  // namespace kelp::bake

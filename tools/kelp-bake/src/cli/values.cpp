// SPDX-License-Identifier: MIT
#include "cli/values.h"

#include <algorithm>

namespace kelp::bake_cli {

std::string Place::prefix() const {
  if (isCommandLine()) return "";
  return file.string() + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

Place placeAt(const std::filesystem::path& file, std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t line_break = before.rfind('\n');
  const std::string_view line = before.substr(line_break == std::string_view::npos ? 0 : line_break + 1);
  // UTF-8
  const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
  return {file, 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')),
          1 + static_cast<std::size_t>(std::count_if(line.begin(), line.end(), starts_character))};
}

Values overlay(Values base, const Values& over) {
  const auto displaces = [&](const char* one, const char* other) {
    if (over.count(one) > 0) base.erase(other);
  };
  displaces("resolution", "voxel-size");
  displaces("voxel-size", "resolution");
  for (const auto& [name, value] : over) base[name] = value;
  return base;
}

ToolError faultAt(const Place& place, const std::string& what) {
  return {place.isCommandLine() ? Exit::kUsage : Exit::kInvalid, place.prefix() + what};
}

}  // namespace kelp::bake_cli

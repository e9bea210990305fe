// SPDX-License-Identifier: MIT
#include "pack_info.h"

#include <nlohmann/json.hpp>

namespace kelp::view {
namespace {

// The text at /outer/inner; empty if there is none.
std::string textAt(const nlohmann::json& info, const char* outer, const char* inner) {
  if (!info.is_object() || !info.contains(outer) || !info[outer].is_object()) return {};
  const nlohmann::json& object = info[outer];
  return object.contains(inner) && object[inner].is_string() ? object[inner].get<std::string>()
                                                             : std::string();
}

// Deep nesting would recurse when the document goes; what kelp-bake writes is 3 levels deep.
bool isShallow(std::string_view text) {
  int depth = 0;
  for (const char c : text) {
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > 32) return false;
  }
  return true;
}

}  // namespace

Axis upAxisOf(std::string_view info_json) {
  if (!isShallow(info_json)) return Axis::kPlusY;
  const nlohmann::json info = nlohmann::json::parse(info_json, nullptr, false);
  if (const auto up = parseAxis(textAt(info, "options", "up"))) return *up;
  return textAt(info, "source", "format") == "MagicaVoxel" ? Axis::kPlusZ : Axis::kPlusY;
}

}  // namespace kelp::view

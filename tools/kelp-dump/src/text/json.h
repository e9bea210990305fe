// SPDX-License-Identifier: MIT
// JSON that kelp-dump prints, and JSON that it reads from a pack.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "kelp/common/console.h"
#include "kelp/common/json_depth.h"

namespace kelp::dump {

// Member "schema" of each document; kelp-dump.schema.json describes them.
inline constexpr const char* kSchemaName = "kelp-dump/1";

template <class V>
nlohmann::ordered_json array3(const V& v) {
  return nlohmann::ordered_json::array({v.x, v.y, v.z});
}

// As text that a terminal may show: bytes that are no UTF-8 become U+FFFD, control characters are escaped.
inline std::string printed(const nlohmann::ordered_json& json) {
  using Json = nlohmann::ordered_json;
  return console::escapeControls(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

// Parses JSON from a pack. Safe for hostile input: nothing if the text is no JSON, if it is nested so deeply
// that printing it (which recurses) would be unsafe, or if it is far larger than what kelp-bake writes
// (ordered_json searches all keys of an object for each one).
inline std::optional<nlohmann::ordered_json> parseSafely(std::string_view text) {
  constexpr int kMaxDepth = 16;
  // Members: as many as a pack has parts, and more than kelp-bake names files.
  constexpr std::size_t kMaxBytes = std::size_t{4} << 20, kMaxMembers = 4096;
  if (text.size() > kMaxBytes || nestedDeeper(text, kMaxDepth) || hasLargerObjects(text, kMaxMembers))
    return std::nullopt;
  auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

}  // namespace kelp::dump

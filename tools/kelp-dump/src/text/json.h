// SPDX-License-Identifier: MIT
// What all JSON that kelp-dump prints has in common.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "kelp/common/console.h"

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

}  // namespace kelp::dump

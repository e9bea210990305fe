// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "kelp/rig_json/json_depth.h"

namespace kelp::dump {

// JSON from a pack, or nothing when it is none or nested so deeply that printing it (which recurses) would be unsafe.
inline std::optional<nlohmann::ordered_json> parseSafely(std::string_view text) {
  constexpr int kMaxDepth = 16;
  if (nestedDeeper(text, kMaxDepth)) return std::nullopt;
  auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

namespace kelp::dump {

// JSON from a pack, or nothing when it is none or nested so deeply that printing it (which recurses) would be unsafe.
inline std::optional<nlohmann::ordered_json> parseSafely(std::string_view text) {
  constexpr int kMaxDepth = 16;
  bool deep = false;
  const auto bounded = [&deep](int depth, nlohmann::ordered_json::parse_event_t, nlohmann::ordered_json&) {
    deep = deep || depth > kMaxDepth;
    return !deep;
  };
  auto json = nlohmann::ordered_json::parse(text, bounded, false);
  if (deep || json.is_discarded()) return std::nullopt;
  return json;
}

}  // namespace kelp::dump

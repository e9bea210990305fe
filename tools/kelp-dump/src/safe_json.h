// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "kelp/rig_json/json_depth.h"

namespace kelp::dump {

// JSON from a pack, or nothing when it is none, nested so deeply that printing it (which recurses) would be unsafe, or far larger than what kelp-bake writes: ordered_json looks for a
// key among all that an object has.
inline std::optional<nlohmann::ordered_json> parseSafely(std::string_view text) {
  constexpr int kMaxDepth = 16;
  constexpr std::size_t kMaxBytes = std::size_t{4} << 20, kMaxMembers = 4096;  // as many as a pack has parts, and more than kelp-bake names files
  if (text.size() > kMaxBytes || nestedDeeper(text, kMaxDepth) || hasLargerObjects(text, kMaxMembers)) return std::nullopt;
  auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

}  // namespace kelp::dump

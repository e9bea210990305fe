// SPDX-License-Identifier: MIT
#include "info/info_document.h"

#include "text/safe_json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

std::string valueText(const nlohmann::ordered_json& value) {
  if (value.is_string()) return nameText(value.get_ref<const std::string&>());
  if (!value.is_object())
    return nameText(value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  std::string text;
  for (const auto& [key, member] : value.items())
    text += (text.empty() ? "" : ", ") + nameText(key) + " " + valueText(member);
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> infoLines(std::string_view document) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto json = parseSafely(document);
  if (!json || !json->is_object()) return lines;
  for (const auto& [key, value] : json->items())
    lines.emplace_back(nameText(key), nameText(valueText(value), 400));
  return lines;
}

}  // namespace kelp::dump

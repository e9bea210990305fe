// SPDX-License-Identifier: MIT
#include "cli/messages.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "kelp/common/console.h"

namespace kelp::bake_cli {
namespace {

using OrderedJson = nlohmann::ordered_json;

bool g_json = false;

std::string lineOf(OrderedJson json, std::string_view before, std::string_view text) {
  const std::string line = console::oneLine(std::string(text));
  if (!g_json) return std::string(before) + line;
  json["text"] = line;
  return console::escapeControls(json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace));
}

// Prints the whole line at once: other processes may write to the same file.
void put(const std::string& line) {
  std::fputs((line + '\n').c_str(), stderr);
  std::fflush(stderr);
}

void say(const char* kind, std::string_view before, std::string_view text) {
  put(lineOf({{"kind", kind}}, before, text));
}

}  // namespace

void speakJson() { g_json = true; }

void sayNote(std::string_view text) { say("note", "kelp-bake: ", text); }

void sayDetail(std::string_view text) { say("detail", "  ", text); }

void sayWarning(std::string_view text) { say("warning", "kelp-bake: warning: ", text); }

std::string errorLine(Exit exit, std::string_view text) {
  return lineOf({{"kind", "error"}, {"exit", static_cast<int>(exit)}}, "kelp-bake: ", text);
}

void sayError(Exit exit, std::string_view text) { put(errorLine(exit, text)); }

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
#include "cli/messages.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "kelp/common/console.h"

namespace kelp::bake_cli {
namespace {

using OrderedJson = nlohmann::ordered_json;

bool g_json = false;

void put(std::string line) {
  line += '\n';
  std::fputs(line.c_str(), stderr);  // whole: other processes may write to the same file
  std::fflush(stderr);
}

std::string lineOf(const OrderedJson& json) {
  return console::escapeControls(json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace));
}

OrderedJson ofKind(const char* kind, const OfBatch& of = {}) {
  OrderedJson json{{"kind", kind}};
  if (of.asset > 0) {
    json["asset"] = of.asset;
    json["assets"] = of.assets;
  }
  return json;
}

std::string number(const OfBatch& of) {
  return of.asset > 0 ? "[" + std::to_string(of.asset) + "/" + std::to_string(of.assets) + "] " : "";
}

std::string lineOf(OrderedJson json, std::string_view before, std::string_view text) {
  const std::string line = console::oneLine(std::string(text));
  if (!g_json) return std::string(before) + line;
  json["text"] = line;
  return lineOf(json);
}

void say(const OrderedJson& json, std::string_view before, std::string_view text) {
  put(lineOf(json, before, text));
}

}  // namespace

void speakJson() { g_json = true; }

void sayNote(std::string_view text) { say(ofKind("note"), "kelp-bake: ", text); }

void sayDetail(std::string_view text) { say(ofKind("detail"), "  ", text); }

void sayWarning(std::string_view text, const OfBatch& of) {
  say(ofKind("warning", of), "kelp-bake: " + number(of) + "warning: ", text);
}

std::string errorLine(Exit exit, std::string_view text) {
  OrderedJson json = ofKind("error");
  json["exit"] = static_cast<int>(exit);
  return lineOf(json, "kelp-bake: ", text);
}

void sayError(Exit exit, std::string_view text) { put(errorLine(exit, text)); }

void sayAsset(const OfBatch& of, std::string_view output, std::string_view status, Exit exit,
              std::string_view text) {
  OrderedJson json = ofKind("asset", of);
  json["output"] = output;
  json["status"] = status;
  json["exit"] = static_cast<int>(exit);
  say(json, "kelp-bake: " + number(of) + console::oneLine(std::string(output)) + ": ", text);
}

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "diff/diff.h"
#include "text/json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr std::size_t kMostDifferences = 40;

// True if it is listed under the heading of its part.
bool ofPart(const Difference& d) {
  return d.kind != "info" && d.kind != "palette" && d.kind != "part" && d.kind != "clip" &&
         d.kind != "motion" && d.kind != "socket";
}

}  // namespace

std::string diffText(const DiffReport& report) {
  const std::string within =
      report.tolerance > 0 ? fmt::format(" within {:g} of the full range", report.tolerance) : "";
  std::string text;
  if (report.same()) {
    text = fmt::format("{} and {} are the same{} ({}, {}, {})\n", nameText(report.a, 4096),
                       nameText(report.b, 4096), within, plural(report.parts, "part"),
                       plural(report.levels, "level"), plural(report.clips, "clip"));
    if (!report.differences.empty()) text += "They were made differently; A is the first:\n";
  } else {
    const auto made =
        static_cast<std::uint64_t>(std::count_if(report.differences.begin(), report.differences.end(),
                                                 [](const Difference& d) { return d.kind == "info"; }));
    text =
        fmt::format("A is {}, B is {}: {}{}{}\n", nameText(report.a, 4096), nameText(report.b, 4096),
                    plural(report.differences.size() - made, "difference"),
                    report.tolerance > 0 ? " not" + within : "", made > 0 ? ", and how they were made" : "");
  }
  const std::string* part = nullptr;
  std::size_t said = 0;
  for (; said < report.differences.size() && said < kMostDifferences; ++said) {
    const Difference& d = report.differences[said];
    if (ofPart(d) && (!part || *part != d.name)) text += fmt::format("  part '{}'\n", nameText(d.name));
    part = ofPart(d) ? &d.name : nullptr;
    text += (ofPart(d) ? "    " : "  ") + d.text + "\n";
  }
  if (said < report.differences.size())
    text += fmt::format("  ... and {} more (--format json lists all)\n", report.differences.size() - said);
  return text;
}

std::string diffJson(const DiffReport& report) {
  using Json = nlohmann::ordered_json;
  Json differences = Json::array();
  for (const Difference& d : report.differences) {
    Json& json = differences.emplace_back(Json{{"kind", d.kind}, {"text", d.text}});
    const auto text = [&](const char* key, const std::string& value) {
      if (!value.empty()) json[key] = value;
    };
    const auto number = [&](const char* key, const auto& value) {
      if (value) json[key] = *value;
    };
    text("only_in", d.only_in);
    text("name", d.name);
    if (d.level >= 0) json["level"] = d.level;
    number("count", d.count);
    number("only_a", d.only_a);
    number("only_b", d.only_b);
    if (d.first) json["first"] = array3(*d.first);
    number("largest", d.largest);
    text("a", d.a);
    text("b", d.b);
  }
  const Json json = {{"schema", kSchemaName},
                     {"command", "diff"},
                     {"a", report.a},
                     {"b", report.b},
                     {"tolerance", report.tolerance},
                     {"same", report.same()},
                     {"differences", differences}};
  return printed(json);
}

}  // namespace kelp::dump

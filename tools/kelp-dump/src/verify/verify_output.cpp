// SPDX-License-Identifier: MIT
#include "verify/issue.h"

#include <algorithm>

#include <fmt/format.h>

#include "text/json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

using Json = nlohmann::ordered_json;

Json issueJson(const Issue& f, const VerifyReport& report) {
  Json json = {{"id", f.id},
               {"severity", f.severity == Severity::kError ? "error" : "warning"},
               {"message", f.message},
               {"detail", f.detail},
               {"count", f.count}};
  if (f.code) json["code"] = toString(*f.code);
  if (f.offset) json["offset"] = *f.offset;
  if (f.part >= 0) {
    json["part"] = f.part;
    if (static_cast<std::size_t>(f.part) < report.part_names.size())
      json["part_name"] = report.part_names[static_cast<std::size_t>(f.part)];
  }
  if (f.level >= 0) json["level"] = f.level;
  if (f.page >= 0) json["page"] = f.page;
  if (f.knot >= 0) json["knot"] = f.knot;
  if (f.brick) json["brick"] = array3(*f.brick);
  if (f.voxel) json["voxel"] = array3(*f.voxel);
  return json;
}

// "reed.kelp: error 401: byte 4096, part 0 'reed', level 1, page 3: checksum mismatch (...). A page of bricks
// cannot be read. ..."
std::string issueText(const Issue& f, const VerifyReport& report) {
  std::string place;
  const auto add = [&place](const std::string& text) { place += (place.empty() ? "" : ", ") + text; };
  if (f.offset) add(fmt::format("byte {}", *f.offset));
  if (f.part >= 0) {
    const auto index = static_cast<std::size_t>(f.part);
    add(index < report.part_names.size()
            ? fmt::format("part {} '{}'", f.part, nameText(report.part_names[index]))
            : fmt::format("part {}", f.part));
  }
  if (f.level >= 0) add(fmt::format("level {}", f.level));
  if (f.page >= 0) add(fmt::format("page {}", f.page));
  if (f.knot >= 0) add(fmt::format("knot {}", f.knot));
  if (f.brick) add(fmt::format("brick ({}, {}, {})", f.brick->x, f.brick->y, f.brick->z));
  if (f.voxel) add(fmt::format("voxel ({}, {}, {})", f.voxel->x, f.voxel->y, f.voxel->z));
  std::string what = f.code ? toString(*f.code) : "";
  if (!f.detail.empty()) what += what.empty() ? f.detail : " (" + f.detail + ")";
  if (f.count > 1)
    what += fmt::format("{}first of {} such places", what.empty() ? "" : "; ", countText(f.count));
  std::string text = fmt::format("{}: {} {}", nameText(report.path, 4096),
                                 f.severity == Severity::kError ? "error" : "warning", f.id);
  for (const std::string& piece : {place, what}) {
    if (!piece.empty()) text += ": " + piece;
  }
  return text + ". " + f.message + "\n";
}

}  // namespace

std::uint64_t VerifyReport::errors() const {
  return static_cast<std::uint64_t>(std::count_if(
      issues.begin(), issues.end(), [](const Issue& f) { return f.severity == Severity::kError; }));
}

std::string verifyText(const VerifyReport& report) {
  std::string text;
  for (const Issue& issue : report.issues) text += issueText(issue, report);
  const char* const deeper = report.distances ? "clearances, levels and distances" : "clearances and levels";
  const std::string checked =
      fmt::format("{}, {}", plural(report.part_names.size(), "part"), plural(report.levels, "level")) +
      (report.deep ? fmt::format(", {} recomputed", deeper)
                   : fmt::format("; --deep recomputes {} as well", deeper));
  if (report.errors() == 0)
    text += fmt::format("{}: sound ({})", nameText(report.path, 4096), checked);
  else
    text += fmt::format("{}: {}", nameText(report.path, 4096), plural(report.errors(), "error"));
  if (report.warnings() > 0) text += ", " + plural(report.warnings(), "warning");
  return text + "\n";
}

std::string verifyJson(const VerifyReport& report) {
  Json issues = Json::array();
  for (const Issue& issue : report.issues) issues.push_back(issueJson(issue, report));
  const Json json = {{"schema", kSchemaName},         {"command", "verify"},
                     {"file", report.path},           {"deep", report.deep},
                     {"sound", report.errors() == 0}, {"parts", report.part_names.size()},
                     {"levels", report.levels},       {"errors", report.errors()},
                     {"warnings", report.warnings()}, {"issues", issues}};
  return printed(json);
}

}  // namespace kelp::dump

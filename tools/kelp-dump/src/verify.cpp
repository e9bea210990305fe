// SPDX-License-Identifier: MIT
#include "kelp/formats/verify.h"

#include <algorithm>

#include <fmt/format.h>

#include "commands.h"
#include "deep_check.h"
#include "finding.h"
#include "json_output.h"
#include "pack_file.h"
#include "text.h"

namespace kelp::dump {
namespace {

Finding findingOf(const Issue& issue) {
  Finding finding;
  finding.id = static_cast<int>(issue.id);
  finding.severity = issue.severity;
  finding.message = toString(issue.id);
  finding.detail = issue.error.detail;
  finding.code = issue.error.code;
  if (issue.error.offset != Error::kNoOffset) finding.offset = issue.error.offset;
  finding.part = issue.part;
  finding.level = issue.level;
  finding.page = issue.page;
  return finding;
}

// "reed.kelp: error 401: byte 4096, part 0 'reed', level 1, page 3: checksum mismatch (...). A page of bricks can not be read. ..."
std::string findingText(const Finding& f, const VerifyReport& report) {
  std::string place;
  const auto add = [&place](const std::string& text) { place += (place.empty() ? "" : ", ") + text; };
  if (f.offset) add(fmt::format("byte {}", *f.offset));
  if (f.part >= 0) {
    const auto index = static_cast<std::size_t>(f.part);
    add(index < report.part_names.size() ? fmt::format("part {} '{}'", f.part, nameText(report.part_names[index])) : fmt::format("part {}", f.part));
  }
  if (f.level >= 0) add(fmt::format("level {}", f.level));
  if (f.page >= 0) add(fmt::format("page {}", f.page));
  if (f.brick) add(fmt::format("brick ({}, {}, {})", f.brick->x, f.brick->y, f.brick->z));
  if (f.voxel) add(fmt::format("voxel ({}, {}, {})", f.voxel->x, f.voxel->y, f.voxel->z));
  std::string what = f.code ? toString(*f.code) : "";
  if (!f.detail.empty()) what += what.empty() ? f.detail : " (" + f.detail + ")";
  if (f.count > 1) what += fmt::format("{}first of {} such places", what.empty() ? "" : "; ", countText(f.count));
  std::string text = fmt::format("{}: {} {}", nameText(report.path, 4096), f.severity == Severity::kError ? "error" : "warning", f.id);
  for (const std::string& piece : {place, what}) {
    if (!piece.empty()) text += ": " + piece;
  }
  return text + ". " + f.message + "\n";
}

std::string verifyText(const VerifyReport& report) {
  std::string text;
  for (const Finding& finding : report.findings) text += findingText(finding, report);
  const std::string checked = fmt::format("{}, {}{}", plural(report.part_names.size(), "part"), plural(report.levels, "level"),
                                          report.deep ? ", empty boxes and levels recomputed" : "; --deep recomputes empty boxes and levels as well");
  if (report.errors() == 0) text += fmt::format("{}: sound ({})", nameText(report.path, 4096), checked);
  else text += fmt::format("{}: {}", nameText(report.path, 4096), plural(report.errors(), "error"));
  if (report.warnings() > 0) text += ", " + plural(report.warnings(), "warning");
  return text + "\n";
}

// 3 for a pack that breaks the rules; 2, 4 or 5 if nothing but the disk, memory or a newer version kept it from being checked.
Exit verdict(const VerifyReport& report) {
  Exit worst = kOk;
  for (const Finding& f : report.findings) {
    if (f.severity != Severity::kError) continue;
    const Exit exit = f.code ? exitCode(*f.code) : kInvalid;
    if (exit == kInvalid) return kInvalid;
    if (worst == kOk) worst = exit;
  }
  return worst;
}

}  // namespace

std::uint64_t VerifyReport::errors() const {
  return static_cast<std::uint64_t>(std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.severity == Severity::kError; }));
}

int verify(const std::string& path, bool deep, Format format) {
  PackFile file(path);
  VerifyReport report;
  report.path = file.path();
  report.deep = deep;
  kelp::verify(
      file.source(), {}, [](void* user, const Issue& issue) { static_cast<VerifyReport*>(user)->findings.push_back(findingOf(issue)); }, &report);
  // A pack that does not open has been reported; what opens is named, and checked deeply if asked.
  if (const Pack* pack = file.packIfSound()) {
    for (const Part& part : pack->parts()) {
      report.part_names.emplace_back(part.name);
      report.levels += static_cast<std::uint64_t>(part.levels);
    }
    if (deep) checkDeeply(file, report);
  }
  print(format == Format::kJson ? verifyJson(report) : verifyText(report));
  return verdict(report);
}

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#include "kelp/formats/verify.h"

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "kelp/common/pack_error.h"
#include "kelp/common/parallel.h"
#include "pack/pack_file.h"
#include "text/text.h"
#include "verify/deep_level.h"
#include "verify/issue.h"

namespace kelp::dump {
namespace {

struct VerifyOptions {
  std::string path, format = "text";
  bool deep = false;
};

Issue issueOf(const kelp::Issue& found) {
  Issue issue;
  issue.id = static_cast<int>(found.id);
  issue.severity = found.severity;
  issue.message = toString(found.id);
  issue.detail = found.error.detail;
  issue.code = found.error.code;
  if (found.error.offset != Error::kNoOffset) issue.offset = found.error.offset;
  issue.part = found.part;
  issue.knot = found.knot;
  issue.level = found.level;
  issue.page = found.page;
  return issue;
}

// 3 if the pack breaks the rules. 2, 4 or 5 if only the disk, the memory or a newer version kept it from
// being checked.
Exit verdict(const VerifyReport& report) {
  Exit worst = Exit::kOk;
  for (const Issue& f : report.issues) {
    if (f.severity != Severity::kError) continue;
    const Exit exit = f.code ? exitOf(*f.code) : Exit::kInvalid;
    if (exit == Exit::kInvalid) return Exit::kInvalid;
    if (worst == Exit::kOk) worst = exit;
  }
  return worst;
}

Exit runVerify(const VerifyOptions& options) {
  const bool json = isJson(options.format);
  PackFile file(options.path);
  VerifyReport report;
  report.path = file.path();
  report.deep = options.deep;
  kelp::verify(
      file.source(), {},
      [](void* user, const kelp::Issue& issue) {
        static_cast<VerifyReport*>(user)->issues.push_back(issueOf(issue));
      },
      &report, {}, threadCount(0));
  // If the pack does not open, the issues say so already.
  if (const Pack* pack = file.packIfSound()) {
    for (const Part& part : pack->parts()) {
      report.part_names.emplace_back(part.name);
      report.levels += static_cast<std::uint64_t>(part.levels);
    }
    report.distances = pack->hasDistances();
    if (options.deep) checkDeeply(file, report);
  }
  print(json ? verifyJson(report) : verifyText(report));
  return verdict(report);
}

}  // namespace

Command addVerify(CLI::App& app) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App* const command =
      addCommand(app, "verify", "Check structure and checksums; list everything that is wrong",
                 "  kelp-dump verify reed.kelp\n"
                 "  kelp-dump verify reed.kelp --deep --format json\n");
  addPack(command, options->path);
  command->add_flag("--deep", options->deep,
                    "also recompute clearances, levels, surface and distances from the voxels, and compare; "
                    "and compare cages with the voxels");
  addFormat(command, options->format);
  return {command, [options] { return runVerify(*options); }};
}

}  // namespace kelp::dump

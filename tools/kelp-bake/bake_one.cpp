// SPDX-License-Identifier: MIT
#include "bake_one.h"

#include <chrono>

#include "clashes.h"
#include "interrupt.h"
#include "report_json.h"
#include "summary.h"

namespace kelp::bake_cli {

Baked bakeOne(const Options& options, const Place& place, ProgressDisplay& display, bool announce) {
  const auto start = std::chrono::steady_clock::now();
  Baked baked;
  bake::Report& report = baked.report;
  const auto progress = [&](std::string_view stage, double done) {
    if (announce && report.estimated_bytes > 0) {
      display.clear();
      printEstimate(options, report);
      announce = false;
    }
    display.show(stage, done);
    return !interrupted();
  };
  const RawPack pack = bake::bake(options.input, options.settings, report, progress);
  std::vector<std::filesystem::path> read;
  for (const bake::FilesUsed::File& file : report.files.read) read.push_back(file.path);
  FileRoles roles;
  addRoles(roles, options, read, place);
  bake::writePackFile(pack, options.output, options.settings.threads, report, progress);
  display.clear();
  baked.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.report_file) writeReport(*options.report_file, options, report, baked.seconds);
  if (options.dependency_file) writeDependencies(*options.dependency_file, options, report);
  return baked;
}

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
// kelp-bake: a thin main over kelp::bake. Every exception ends here, as an exit code and one line.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "clashes.h"
#include "interrupt.h"
#include "options.h"
#include "progress_display.h"
#include "report_json.h"
#include "summary.h"

namespace {

using kelp::bake::BakeError;
using kelp::bake::Exit;
using namespace kelp::bake_cli;

// Before the work: what is known of the files without reading them.
void checkPaths(const Options& options) {
  std::error_code error;
  if (!std::filesystem::exists(options.input, error)) throw BakeError(Exit::kIo, options.input.string() + ": no such file; check the name");
  std::vector<std::filesystem::path> read{options.input};
  if (options.settings.rig_file) read.push_back(*options.settings.rig_file);
  checkClashes(options, read);
  kelp::bake::checkOutput(options.output);
}

void run(const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  checkPaths(options);
  catchInterrupts();
  kelp::bake::Report report;
  ProgressDisplay display(options.progress);
  bool announced = false;
  const auto progress = [&](std::string_view stage, double done) {
    if (!announced && report.estimated_bytes > 0) {
      display.clear();
      printEstimate(options, report);
      announced = true;
    }
    display.show(stage, done);
    return !interrupted();
  };
  const kelp::RawPack pack = kelp::bake::bake(options.input, options.settings, report, progress);
  checkClashes(options, report.files_read);
  kelp::bake::writePackFile(pack, options.output, options.settings.threads, report, progress);
  display.clear();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.report_file) writeReport(*options.report_file, options, report, seconds);
  if (options.dependency_file) writeDependencies(*options.dependency_file, options, report);
  printSummary(options, report, seconds);
}

// One line whatever the message holds.
int complain(Exit code, std::string message) {
  std::replace_if(message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  std::fprintf(stderr, "kelp-bake: %s\n", message.c_str());
  return static_cast<int>(code);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (const std::optional<Options> options = parseOptions(argc, argv)) run(*options);
    return static_cast<int>(Exit::kOk);
  } catch (const BakeError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(Exit::kRuntime, "out of memory; lower --resolution");
  } catch (const std::exception& error) {
    return complain(Exit::kRuntime, std::string("unexpected: ") + error.what() + "; please report this as a defect");
  }
}

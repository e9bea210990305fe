// SPDX-License-Identifier: MIT
// kelp-bake: a thin main over kelp::bake. Every exception ends here, as an exit code and one line.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "bake_one.h"
#include "batch.h"
#include "batch_jobs.h"
#include "clashes.h"
#include "command_line.h"
#include "config_file.h"
#include "interrupt.h"
#include "summary.h"

namespace {

using kelp::bake::BakeError;
using kelp::bake::Exit;
using namespace kelp::bake_cli;

void runSingle(const Command& command) {
  Options options = readOptions(overlay(command.config, command.options));
  options.option_files = command.option_files;
  std::error_code error;
  if (!std::filesystem::exists(options.input, error)) throw BakeError(Exit::kIo, options.input.string() + ": no such file; check the name");
  // Before the work: what is known of the files without reading them.
  FileRoles roles;
  addRoles(roles, options, {}, {});
  if (options.cache_folder) roles.addFolder(*options.cache_folder, "--cache");
  catchInterrupts();
  checkDestinations(options);
  const std::optional<Cache> cache = openCache(options);
  ProgressDisplay display(options.progress);
  const Baked baked = bakeOne(options, {}, cache ? &*cache : nullptr, display, true);
  if (baked.cached) {
    printCached(options, baked.notices, baked.pack_bytes, baked.seconds);
  } else {
    printSummary(options, baked.report, baked.seconds);
  }
}

int complain(Exit code, const std::string& message) {
  std::fprintf(stderr, "kelp-bake: %s\n", oneLine(message).c_str());
  return static_cast<int>(code);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::optional<Command> command = parseCommandLine(argc, argv);
    if (!command) return static_cast<int>(Exit::kOk);
    if (command->print_config) {
      const Values values = overlay(command->config, command->options);
      readOptions(values);  // what can not be is no reference
      writeStdout(printConfig(values));
      return static_cast<int>(Exit::kOk);
    }
    if (command->isBatch()) return static_cast<int>(runBatch(*command));
    runSingle(*command);
    return static_cast<int>(Exit::kOk);
  } catch (const BatchFaults& several) {
    for (const BakeError& fault : several.faults) complain(fault.exit, fault.what());
    if (several.faults.size() > 1) std::fprintf(stderr, "kelp-bake: %zu faults, and nothing was baked\n", several.faults.size());
    return static_cast<int>(several.exit);
  } catch (const BakeError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(Exit::kRuntime, "out of memory; lower --resolution");
  } catch (const std::exception& error) {
    return complain(Exit::kRuntime, std::string("unexpected: ") + error.what() + "; please report this as a defect");
  }
}

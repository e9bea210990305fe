// SPDX-License-Identifier: MIT
// kelp-bake: a thin main over kelp::bake. Every exception ends here, as an exit code and a line for each
// fault.
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "batch/batch.h"
#include "batch/batch_jobs.h"
#include "cli/bake_one.h"
#include "cli/clashes.h"
#include "cli/command_line.h"
#include "cli/config_file.h"
#include "cli/faults.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/summary.h"
#include "kelp/common/console.h"

namespace {

using namespace kelp::bake_cli;
using kelp::Exit;
using kelp::ToolError;

Exit complain(Exit code, const std::string& message) {
  sayError(code, message);
  return code;
}

// What ends here becomes an exit code and a line for each fault.
Exit guarded(const std::function<Exit()>& work) {
  try {
    return work();
  } catch (const SeveralFaults& several) {
    for (const ToolError& fault : several.faults) complain(fault.exit, fault.what());
    const std::string told =
        several.faults.size() < several.count
            ? ", of which the first " + std::to_string(several.faults.size()) + " are told"
            : "";
    return complain(several.exit,
                    std::to_string(several.count) + " faults" + told + ", and nothing was baked");
  } catch (const ToolError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(Exit::kRuntime, "out of memory; lower --resolution");
  } catch (const std::exception& error) {
    return complain(Exit::kRuntime,
                    std::string("unexpected: ") + error.what() + "; please report this as a defect");
  }
}

Exit runSingle(const Command& command) {
  Options options = readOptions(overlay(command.config, command.options));
  options.option_files = command.option_files;
  std::error_code error;
  if (!std::filesystem::exists(options.input, error))
    throw ToolError(Exit::kIo, options.input.string() + ": no such file; check the name");
  // Before the work: check all files that are known without reading the input.
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
  return Exit::kOk;
}

// Before parsing, so that even usage errors are printed as JSON if --progress json is given.
bool asksForJson(const std::vector<std::string>& words) {
  for (std::size_t i = 1; i < words.size(); ++i)
    if (words[i] == "--progress=json" || (words[i] == "json" && words[i - 1] == "--progress")) return true;
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  kelp::console::prepareStreams();
  return static_cast<int>(guarded([&] {
    const std::vector<std::string> words = kelp::console::arguments(argc, argv);
    if (asksForJson(words)) speakJson();
    const std::optional<Command> command = parseCommandLine(words);
    if (!command) return Exit::kOk;
    const Values values = overlay(command->config, command->options);
    if (const auto progress = values.find("progress");
        progress != values.end() && progress->second.text == "json")
      speakJson();
    if (command->print_config) {
      readOptions(values);  // what cannot be is no reference
      writeStdout(printConfig(values));
      return Exit::kOk;
    }
    return command->isBatch() ? runBatch(*command) : runSingle(*command);
  }));
}

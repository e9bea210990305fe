// SPDX-License-Identifier: MIT
// The sub-commands. Each file of this folder adds one to the command line, with its options, and runs it.
#pragma once

#include <functional>
#include <string>

#include "kelp/common/error.h"

namespace CLI {
class App;
}

namespace kelp::dump {

struct Command {
  CLI::App* options;
  // Call it after the command line was read. It prints data to standard output and notes to standard error.
  // ToolError.
  std::function<Exit()> run;
};

Command addInfo(CLI::App& app);
Command addVerify(CLI::App& app);
Command addDiff(CLI::App& app);
Command addRig(CLI::App& app);
Command addExtract(CLI::App& app);
Command addSlice(CLI::App& app);
Command addSchema(CLI::App& app);

// The formats that `extract` of this build can write: "vox, ply, slices".
std::string extractFormats();

}  // namespace kelp::dump

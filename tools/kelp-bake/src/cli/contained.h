// SPDX-License-Identifier: MIT
// Runs a bake in a child process. Some libraries that read files are not safe for hostile input. If one
// crashes, hangs or uses up the memory, only the child ends, and this process reports an error.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "cli/options.h"
#include "cli/progress_display.h"

namespace kelp::bake_cli {

struct Outcome {
  Exit exit = Exit::kOk;
  std::string text;
};

// Runs `work` in a child process and returns its exit code. The child shares the standard streams and ends
// with this process. interrupted() is passed on to the child. During import, which cannot be stopped in
// order, or if the child does not react for seconds, the child is killed. Throws ToolError kRuntime with the
// input's name if the child crashes or exceeds a limit, and kInterrupted. Call it before this program starts
// threads.
Outcome contained(const Options& options, ProgressDisplay& display, const std::function<Outcome()>& work);

// Called by `work` at every step. Limits memory (Settings::max_memory, else the machine's) and time
// (Options::max_import_seconds) during the stage "import". Does nothing outside a child process.
void enterStage(std::string_view stage);

}  // namespace kelp::bake_cli

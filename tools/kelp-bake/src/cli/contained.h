// SPDX-License-Identifier: MIT
// A bake in a process of its own. Files come from anywhere, and not every library that reads them was made
// for that: what one of them crashes on, hangs on or fills the memory for ends that process alone, and is an
// error of this one.
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

// Runs `work` in a child of this process and answers what it does. The child shares the standard streams, and
// ends with this process however that ends. interrupted() here is heard there; while a file is imported,
// which no one can stop in order, or where it is not heard for seconds, the child is ended instead. ToolError
// kRuntime, naming the input, if the child ends in any other way than by its outcome or exceeds a limit;
// kInterrupted. Before the program has started a thread of its own.
Outcome contained(const Options& options, ProgressDisplay& display, const std::function<Outcome()>& work);

// For `work`, at every step: memory (Settings::max_memory, else the machine's) and time
// (Options::max_import_seconds) are bounded from the stage "import" to the one after. Does nothing where
// nothing contains it.
void enterStage(std::string_view stage);

}  // namespace kelp::bake_cli

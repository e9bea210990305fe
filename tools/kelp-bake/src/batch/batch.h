// SPDX-License-Identifier: MIT
// Many assets, one after another, each with all threads.
#pragma once

#include "cli/command_line.h"

namespace kelp::bake_cli {

// Bakes a batch, or prints its plan. Checks all assets before the first bake and throws ToolError only then.
// After that a bad asset stops no other. Returns the highest exit code of all assets, 130 if interrupted.
Exit runBatch(const Command& command);

}  // namespace kelp::bake_cli

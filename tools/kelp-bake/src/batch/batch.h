// SPDX-License-Identifier: MIT
// Many assets, one after another, each with all threads.
#pragma once

#include "cli/command_line.h"

namespace kelp::bake_cli {

// Bakes what the command names, or prints the plan. Everything is checked before the first asset is baked:
// ToolErrors are thrown then only. Afterwards a bad asset stops no other; answers the highest exit code of
// them all, 130 if it was interrupted.
Exit runBatch(const Command& command);

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
#pragma once

#include "cli/options.h"

namespace kelp::bake_cli {

// Bakes the input: pack, report and rule; prints progress and a summary on stderr. Throws ToolError;
// kInterrupted soon after a signal. On an error, existing files stay as they were and no others are left.
void bakeOne(const Options& options);

}  // namespace kelp::bake_cli

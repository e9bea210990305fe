// SPDX-License-Identifier: MIT
// The child process of contained.h.
#pragma once

#include <filesystem>
#include <vector>

#include <sys/types.h>

#include "cli/options.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {

// The paths that the child may read: the files that this format and these options name, and the input's
// folder with all below. A link that leads out of that folder cannot be followed, unless it is one of those
// files.
std::vector<std::filesystem::path> placesToRead(const Options& options);

// Bakes into `output` and sends messages to `pipe`. Output of libraries goes to `prints`. Never returns.
[[noreturn]] void runChild(pid_t parent, int pipe, int prints, const Options& options, OutputFile& output);

}  // namespace kelp::bake_cli

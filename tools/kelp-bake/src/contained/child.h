// SPDX-License-Identifier: MIT
// The child process of contained.h.
#pragma once

#include <filesystem>
#include <vector>

#include <sys/types.h>

#include "cli/options.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {

// What the child may read, by name: the files that this format and these options read, and the input's folder
// with all below. A link in that folder that leads out of it cannot be followed, unless it is one of those
// files.
std::vector<std::filesystem::path> placesToRead(const Options& options);

// Bakes into `output` and tells `pipe` how it goes. What libraries print goes to `prints`. Never returns.
[[noreturn]] void runChild(pid_t parent, int pipe, int prints, const Options& options, OutputFile& output);

}  // namespace kelp::bake_cli

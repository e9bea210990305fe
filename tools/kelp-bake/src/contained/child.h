// SPDX-License-Identifier: MIT
// The child process of contained.h.
#pragma once

#include <filesystem>
#include <vector>

#include <sys/types.h>

#include "cli/options.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {

// What the child may read, by name: files, and the input's folder with all below. Links in it that the user
// put there may lead out of it.
std::vector<std::filesystem::path> placesToRead(const Options& options);

// Bakes into `output` and tells `pipe` how it goes. What libraries print goes to `prints`. Never returns.
[[noreturn]] void runChild(pid_t parent, int pipe, int prints, const Options& options, OutputFile& output);

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "cli/options.h"

namespace kelp::bake_cli {

// Throws ToolError kUsage if the bake would overwrite a file that it reads (the input, what the options name,
// and `read`), or write two outputs to one file. Links of both kinds are followed. Only regular files count:
// /dev/null may be named twice.
void checkClashes(const Options& options, const std::vector<std::filesystem::path>& read = {});

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
// Keeps a bake from writing over what it reads, or over its own output.
#pragma once

#include <vector>

#include "options.h"

namespace kelp::bake_cli {

// BakeError kUsage, with both names, if two of the files to write are one, or if one of them is among `files_read`: by name, through links of
// either kind, or by different ways to one folder. What is no regular file (/dev/null) holds nothing that could be lost, and may be named twice.
void checkClashes(const Options& options, const std::vector<std::filesystem::path>& files_read);

}  // namespace kelp::bake_cli

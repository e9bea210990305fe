// SPDX-License-Identifier: MIT
// What a pack says about its making.
#pragma once

#include "kelp/bake/bake.h"

namespace kelp::bake {

// The pack's INFO: tool version, source name and hash, the options that change content. Nothing that differs between two bakes of the
// same input: no path, time or number of threads.
// `files_read` tells whether a rig was found beside the input.
std::string makeInfo(const std::filesystem::path& input, const std::string& format, bool volume, const Settings& settings, const std::vector<std::filesystem::path>& files_read);

}  // namespace kelp::bake

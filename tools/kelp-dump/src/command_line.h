// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "kelp/common/error.h"

namespace kelp::dump {

// Reads the command line, whose first word is the program, and runs the sub-command. ToolError; kUsage if the
// command line is wrong.
Exit runCommandLine(const std::vector<std::string>& words);

}  // namespace kelp::dump

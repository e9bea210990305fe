// SPDX-License-Identifier: MIT
// The command line.
#pragma once

#include <string>
#include <vector>

namespace kelp::dump {

// Reads the command line, whose first word is the program, and runs what it asks for. Answers the exit code; DumpError (kUsage) for what makes no sense.
int runCommandLine(const std::vector<std::string>& words);

}  // namespace kelp::dump

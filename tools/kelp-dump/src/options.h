// SPDX-License-Identifier: MIT
// The command line.
#pragma once

namespace kelp::dump {

// Reads the command line and runs what it asks for. Answers the exit code; DumpError (kUsage) for what makes no sense.
int runCommandLine(int argc, char** argv);

}  // namespace kelp::dump

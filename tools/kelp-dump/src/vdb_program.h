// SPDX-License-Identifier: MIT
// OpenVDB and the libraries beneath it take longer to load than most packs to verify: what needs them is in a program of its own.
#pragma once

#include <string>
#include <vector>

namespace kelp::dump {

// Becomes kelp-dump-vdb, which is this program with OpenVDB: the same process, standard input and output, and these arguments. It stands beside this program, or in
// ../libexec/kelp. DumpError: kUnsupported if it is not there, kFailure if it can not be run.
[[noreturn]] void becomeVdbProgram(std::vector<std::string> arguments);

}  // namespace kelp::dump

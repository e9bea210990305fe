// SPDX-License-Identifier: MIT
// How kelp's programs fail: one list of exit codes and one exception type.
#pragma once

#include <stdexcept>
#include <string>

namespace kelp {

// Exit codes of every kelp program.
enum class Exit : int {
  kOk = 0,
  kUsage = 1,        // the command line is wrong
  kIo = 2,           // a file cannot be read or written
  kInvalid = 3,      // a file is damaged or contradicts itself
  kRuntime = 4,      // too little memory, no OpenGL, or a defect of kelp
  kUnsupported = 5,  // the file is sound, but kelp cannot do this with it
  kDifference = 7,   // kelp-dump diff: the packs differ
  kInterrupted = 130
};

// The exception of the tools' libraries. Each program catches it in main() and ends with `exit`.
// what() is one line: file, place, fault; remedy.
struct ToolError : std::runtime_error {
  ToolError(Exit code, const std::string& what) : std::runtime_error(what), exit(code) {}
  Exit exit;
};

}  // namespace kelp

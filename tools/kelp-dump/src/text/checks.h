// SPDX-License-Identifier: MIT
// Checks before long work: of a place for output, of memory.
#pragma once

#include <cstdint>
#include <string>

namespace kelp::dump {

// Checks a place for output that is no text, before long work. ToolError if `output` is "-" and standard
// output is a terminal, which cannot show `what` ("a PNG"); if it names an open stream (/dev/stdout); or if
// it is the file `input` under any name.
void checkBinaryOutput(const std::string& output, const std::string& input, const char* what);

// ToolError kRuntime if this machine has less than `needed` bytes of memory: "WHAT needs 3 GiB of memory,
// this machine has 2 GiB; REMEDY".
void requireMemory(std::uint64_t needed, const std::string& what, const std::string& remedy);

}  // namespace kelp::dump

// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace kelp::dump {

// Checks a place for output that is no text, before long work. ToolError if `output` is "-" and standard
// output is a terminal, which cannot show `what` ("a PNG"); if it names an open stream (/dev/stdout); or if
// it is the file `input` under any name. An `input` of "-" is standard input.
void checkBinaryOutput(const std::string& output, const std::string& input, const char* what);

}  // namespace kelp::dump

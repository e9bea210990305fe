// SPDX-License-Identifier: MIT
// Options in a file: lines of `name = value`, a part of TOML.
#pragma once

#include "cli/values.h"

namespace kelp::bake_cli {

// Names of files in it are relative to its folder. ToolError, SeveralFaults with line and column for what is
// not understood, kIo if it cannot be read. Safe for hostile files.
Values readConfig(const std::filesystem::path& file);

// Every option with what it means, commented out but for those of `values`; read back, it says what `values`
// says. Names of files become absolute.
std::string printConfig(const Values& values);

}  // namespace kelp::bake_cli

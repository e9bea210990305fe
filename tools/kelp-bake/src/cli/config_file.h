// SPDX-License-Identifier: MIT
// Options in a file: lines of `name = value`, a part of TOML.
#pragma once

#include "cli/values.h"

namespace kelp::bake_cli {

// Reads a configuration. File names in it are relative to its folder. Throws ToolError or SeveralFaults with
// line and column, kIo if the file cannot be read. Safe for hostile files.
Values readConfig(const std::filesystem::path& file);

// Every option with its meaning, commented out except those of `values`. Reading the text back gives
// `values`. File names become absolute.
std::string printConfig(const Values& values);

}  // namespace kelp::bake_cli

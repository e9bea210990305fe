// SPDX-License-Identifier: MIT
// Reports as JSON, and make rules.
#pragma once

#include <string>

#include "cli/options.h"
#include "contained/sandbox.h"

namespace kelp::bake_cli {

// The JSON of --report (kelp-bake-report.schema.json).
std::string reportJson(const Options& options, const bake::Report& report, const Containment& containment,
                       double seconds);
// Throws ToolError kIo if a make rule cannot name one of the files.
void checkDependencies(const Options& options, const bake::FilesUsed& files);
// Writes a make rule: the pack depends on all files that were read. Throws ToolError kIo.
void writeDependencies(const std::filesystem::path& path, const Options& options,
                       const bake::FilesUsed& files);

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
// What was baked, for programs.
#pragma once

#include <string>
#include <vector>

#include "cli/options.h"

namespace kelp::bake_cli {

// What --report writes, as kelp-bake-report.schema.json beside this file describes it.
std::string reportJson(const Options& options, const bake::Report& report, double seconds);
// The same of a pack that comes from the cache, where `report` is that of its bake.
std::string cachedReport(const std::string& report, const Options& options, const bake::FilesUsed& files,
                         double seconds);
// Whether a text, which may come from anywhere, is a report that the functions here can read.
bool isReport(const std::string& text);
std::vector<std::string> noticesOf(const std::string& report);
std::string inputOf(const std::string& report);
// ToolError kIo if no make rule can name one of the files.
void checkDependencies(const Options& options, const bake::FilesUsed& files);
// Writes a make rule: the pack depends on all files that were read. ToolError kIo.
void writeDependencies(const std::filesystem::path& path, const Options& options,
                       const bake::FilesUsed& files);

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
// What was baked, for programs.
#pragma once

#include "options.h"

namespace kelp::bake_cli {

// Writes --report, as kelp-bake-report.schema.json beside this file describes it. BakeError kIo if it can not be written.
void writeReport(const std::filesystem::path& path, const Options& options, const bake::Report& report, double seconds);
// Writes a make rule: the pack depends on all files that were read. BakeError kIo.
void writeDependencies(const std::filesystem::path& path, const Options& options, const bake::Report& report);

}  // namespace kelp::bake_cli

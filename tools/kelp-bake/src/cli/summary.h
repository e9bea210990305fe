// SPDX-License-Identifier: MIT
// The result of a bake as lines for people.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "cli/options.h"

namespace kelp::bake_cli {

// By std::chrono::steady_clock.
double secondsSince(std::chrono::steady_clock::time_point start);

// Throws ToolError kIo if stdout does not take all of it.
void writeStdout(const std::string& text);

// Before the work: prints on stderr how much memory it takes.
void printEstimate(const Options& options, std::uint64_t bytes);
// Prints on stderr: the input, parts, warnings, clips, the pack.
void printSummary(const Options& options, const bake::Report& report, double seconds);

}  // namespace kelp::bake_cli

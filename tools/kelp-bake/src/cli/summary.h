// SPDX-License-Identifier: MIT
// What was baked, as lines for people.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/options.h"

namespace kelp::bake_cli {

// By std::chrono::steady_clock.
double secondsSince(std::chrono::steady_clock::time_point start);
// "1.5 MiB".
std::string printBytes(std::uint64_t bytes);

// Throws ToolError kIo if stdout does not take all of it.
void writeStdout(const std::string& text);

// Before the work: prints on stderr how much memory it takes.
void printEstimate(const Options& options, std::uint64_t bytes);
// Prints on stderr: the input, parts, warnings, clips, the pack.
void printSummary(const Options& options, const bake::Report& report, double seconds);

// The same for a pack from the cache.
void printCached(const Options& options, const std::vector<std::string>& notices, std::uint64_t pack_bytes,
                 double seconds);

}  // namespace kelp::bake_cli

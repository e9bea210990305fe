// SPDX-License-Identifier: MIT
// What was baked, for people.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/options.h"

namespace kelp::bake_cli {

// By the steady clock.
double secondsSince(std::chrono::steady_clock::time_point start);
// "1.5 MiB".
std::string printBytes(std::uint64_t bytes);

// ToolError kIo if not all of it could be written.
void writeStdout(const std::string& text);

// A line on stderr, before the work: what it will take.
void printEstimate(const Options& options, const bake::Report& report);
// Lines on stderr: what was understood, warnings, clips, what was written.
void printSummary(const Options& options, const bake::Report& report, double seconds);

// The same of a pack that came from the cache.
void printCached(const Options& options, const std::vector<std::string>& notices, std::uint64_t pack_bytes,
                 double seconds);

}  // namespace kelp::bake_cli

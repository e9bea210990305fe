// SPDX-License-Identifier: MIT
// Lines on stderr, as text or as JSON (kelp-bake-progress.schema.json): single ones, and the result of a
// bake.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "cli/options.h"
#include "kelp/common/error.h"

namespace kelp::bake_cli {

// Every line from now on is JSON. Default: text.
void speakJson();

// Each prints one line; line breaks in the text are escaped.
void sayNote(std::string_view text);                      // "kelp-bake: wrote reed.kelp: ..."
void sayDetail(std::string_view text);                    // of the note before it: "  part 'reed': ..."
void sayWarning(std::string_view text);                   // "kelp-bake: warning: ..."
void sayError(Exit exit, std::string_view text);          // "kelp-bake: ..."
std::string errorLine(Exit exit, std::string_view text);  // the line of sayError, without its end

// By std::chrono::steady_clock.
double secondsSince(std::chrono::steady_clock::time_point start);

// Throws ToolError kIo if stdout does not take all of it.
void writeStdout(const std::string& text);

// Before the work: prints on stderr how much memory it takes.
void printEstimate(const Options& options, std::uint64_t bytes);
// Prints on stderr: the input, parts, warnings, clips, the pack.
void printSummary(const Options& options, const bake::Report& report, double seconds);

}  // namespace kelp::bake_cli

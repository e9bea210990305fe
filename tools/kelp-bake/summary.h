// SPDX-License-Identifier: MIT
// What was baked, for people.
#pragma once

#include "options.h"

namespace kelp::bake_cli {

// A line on stderr, before the work: what it will take.
void printEstimate(const Options& options, const bake::Report& report);
// Lines on stderr: what was understood, warnings, clips, what was written.
void printSummary(const Options& options, const bake::Report& report, double seconds);

}  // namespace kelp::bake_cli

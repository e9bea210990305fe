// SPDX-License-Identifier: MIT
// Runs a bake in a sandboxed child process, because libraries that read files are not safe for hostile input.
// If the child crashes, hangs, fills the memory or makes a forbidden call, only the child ends, and this
// process reports an error.
#pragma once

#include <functional>

#include "cli/options.h"
#include "contained/wire.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {

struct Contained {
  bake::Report report;
  Containment containment;  // of the child
};

// Bakes `options.input` into `output` in a child process; commit() is the caller's, after it has checked the
// pack. `show` is called with the steps of the bake.
//
// The child may read the input's folder, the files that the options name and the system's libraries; it may
// write what is open: the output and its pipes. Memory is limited by Settings::max_memory or the machine's,
// the output by the machine's. Options::max_import_seconds limits the import, and every later step that shows
// no progress. interrupted() is passed on. If the child does not react for seconds, it is killed. It ends
// with this process.
//
// Throws the bake's ToolError; kRuntime with the input's name if the child crashes, exceeds a limit or makes
// a forbidden call; kInterrupted. Call it while this program has no threads of its own.
Contained bakeContained(const Options& options, OutputFile& output,
                        const std::function<void(const Stage&)>& show);

}  // namespace kelp::bake_cli

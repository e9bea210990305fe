// SPDX-License-Identifier: MIT
// Runs a bake in a sandboxed child process, because libraries that read files are not safe for hostile input.
// If the child crashes, hangs, fills the memory or makes a forbidden call, only the child ends, and this
// process reports an error.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include <sys/types.h>

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

// The paths that the child may read: the files that this format and these options name, and the input's
// folder with all below. A link that leads out of that folder cannot be followed, unless it is one of those
// files.
std::vector<std::filesystem::path> placesToRead(const Options& options);

// The child process. Bakes into `output` and sends messages to `pipe`. Output of libraries goes to `prints`.
// Never returns.
[[noreturn]] void runChild(pid_t parent, int pipe, int prints, const Options& options, OutputFile& output);

}  // namespace kelp::bake_cli

// SPDX-License-Identifier: MIT
// The sub-commands. Each file of this folder adds one to the command line, with its options, and runs it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kelp/common/error.h"

namespace CLI {
class App;
}

namespace kelp::dump {

// Reads the command line, whose first word is the program, and runs the sub-command. ToolError; kUsage if the
// command line is wrong.
Exit runCommandLine(const std::vector<std::string>& words);

struct Command {
  CLI::App* options;
  // Call it after the command line was read. It prints data to standard output and notes to standard error.
  // ToolError.
  std::function<Exit()> run;
};

Command addInfo(CLI::App& app);
Command addVerify(CLI::App& app);
Command addDiff(CLI::App& app);
Command addRig(CLI::App& app);
Command addExtract(CLI::App& app);
Command addSlice(CLI::App& app);
Command addSchema(CLI::App& app);

// The formats that `extract` of this build can write: "vox, vdb, nvdb".
std::string extractFormats();

// Options that several sub-commands have. The variables must live until the command has run.

// The last lines of every --help.
extern const char* const kExitCodes;

// A sub-command whose --help ends with these examples.
CLI::App* addCommand(CLI::App& app, const char* name, const char* what, const std::string& examples);

void addPack(CLI::App* command, std::string& path);
void addFormat(CLI::App* command, std::string& format);
// `otherwise`: the default, in words.
void addPart(CLI::App* command, std::string& part, const char* otherwise);
void addLevel(CLI::App* command, int& level);

// True for "json", false for "text". ToolError kUsage for anything else.
bool isJson(const std::string& format);

// The published JSON schemas: the build embeds the files of the source tree. Static storage, NUL-terminated.
extern const char* const kDumpSchema;      // tools/kelp-dump/kelp-dump.schema.json
extern const char* const kRigSchema;       // tools/rig/rig.schema.json
extern const char* const kReportSchema;    // tools/kelp-bake/kelp-bake-report.schema.json
extern const char* const kProgressSchema;  // tools/kelp-bake/kelp-bake-progress.schema.json

}  // namespace kelp::dump

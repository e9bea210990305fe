// SPDX-License-Identifier: MIT
// Options that several sub-commands have. The variables must live until the command has run.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace kelp::dump {

// The last lines of every --help.
extern const char* const kExitCodes;

// A sub-command whose --help ends with these examples.
CLI::App* addCommand(CLI::App& app, const char* name, const char* what, const std::string& examples);

void addPack(CLI::App* command, std::string& path);
void addFormat(CLI::App* command, std::string& format);
// `otherwise`: the default, in words.
void addPart(CLI::App* command, std::string& part, const char* otherwise);
void addLevel(CLI::App* command, int& level);

// Whether `format` is "json". ToolError kUsage if it is neither "text" nor "json".
bool isJson(const std::string& format);

}  // namespace kelp::dump

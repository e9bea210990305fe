// SPDX-License-Identifier: MIT
#include "commands/commands.h"

#include <CLI/CLI.hpp>

#include "kelp/common/error.h"

namespace kelp::dump {

const char* const kExitCodes =
    "Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack or rig, 4 failure at run time, 5 unsupported "
    "feature, 7 difference found, 130 interrupted.";

CLI::App* addCommand(CLI::App& app, const char* name, const char* what, const std::string& examples) {
  CLI::App* const command = app.add_subcommand(name, what);
  command->footer("Examples:\n" + examples + "\n" + kExitCodes);
  return command;
}

void addPack(CLI::App* command, std::string& path) {
  command->add_option("PACK", path, "the .kelp file")->required();
}

void addFormat(CLI::App* command, std::string& format) {
  command
      ->add_option("--format", format, "text for people, JSON for programs (kelp-dump schema describes it)")
      ->option_text("text|json [text]");
}

void addPart(CLI::App* command, std::string& part, const char* otherwise) {
  command->add_option("--part", part, "name or index of the part")
      ->option_text(std::string("NAME|INDEX [") + otherwise + "]");
}

void addLevel(CLI::App* command, int& level) {
  command->add_option("--level", level, "level of detail: each has half the voxels along a side")
      ->option_text("N [0, the finest]");
}

bool isJson(const std::string& format) {
  if (format != "text" && format != "json")
    throw ToolError(Exit::kUsage, "--format " + format + ": expected text or json; see kelp-dump --help");
  return format == "json";
}

}  // namespace kelp::dump

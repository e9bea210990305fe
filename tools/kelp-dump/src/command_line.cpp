// SPDX-License-Identifier: MIT
#include "commands/commands.h"

#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr const char* kCommands =
    "use info, verify, diff, rig, extract, slice or schema, see kelp-dump --help";
constexpr const char* kExamples =
    "Examples:\n"
    "  kelp-dump info reed.kelp                     what it is, its parts, clips and colors, where the "
    "bytes "
    "go\n"
    "  kelp-dump verify reed.kelp --deep            recompute clearances, levels, distances; compare\n"
    "  kelp-dump diff old.kelp new.kelp             which parts, voxels, colors, rigs and clips differ\n"
    "  kelp-dump rig reed.kelp > reed.rig.json      its rigs as kelp-bake --rig reads them\n"
    "  kelp-dump extract reed.kelp --vox reed.vox   its voxels for MagicaVoxel; or --vdb, --nvdb, --npy, "
    "--proxy\n"
    "  kelp-dump slice reed.kelp -o layer.png       a layer of voxels as a picture\n"
    "\n"
    "kelp-dump COMMAND --help says more. ";

// Options of earlier versions, and what to use instead.
constexpr std::pair<std::string_view, std::string_view> kGone[] = {
    {"--set", "bake again with kelp-bake --rig, or edit the rig in kelp-view"},
    {"--ply", "use --proxy OUT.ply for a surface, --vox or --vdb for colors"},
    {"--slices", "use kelp-dump slice for a layer, --npy for all voxels"}};

void refuseGone(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    for (const auto& [option, instead] : kGone)
      if (word == option || word.starts_with(std::string(option) + "="))
        throw ToolError(Exit::kUsage, fmt::format("{} is gone; {}", option, instead));
}

// Says what is wrong with the command line. CLI11's own words help little.
[[noreturn]] void failUsage(const CLI::App& app, const std::string& first, const CLI::ParseError& error) {
  if (first.empty()) throw ToolError(Exit::kUsage, std::string("no sub-command; ") + kCommands);
  if (first[0] == '-')
    throw ToolError(Exit::kUsage, nameText(first, 40) +
                                      ": is not an option of kelp-dump itself, which begins with a "
                                      "sub-command; " +
                                      kCommands);
  // An unknown word is named first: it may be why another is missing.
  const std::vector<std::string> unknown = app.remaining(true);
  refuseGone(unknown);
  const std::string what =
      unknown.empty() ? std::string(error.what()) : nameText(unknown.front()) + ": is not expected here";
  throw ToolError(Exit::kUsage, what + "; see kelp-dump " + first + " --help");
}

void refuseEmptyValues(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    for (const std::string& value : option->results())
      if (value.empty())
        throw ToolError(Exit::kUsage, option->get_name() +
                                          ": is empty; give a value, or leave it out; see kelp-dump " +
                                          command.get_name() + " --help");
}

}  // namespace

Exit runCommandLine(const std::vector<std::string>& words) {
  CLI::App app(
      "Says what is in a .kelp pack and whether it is sound, and extracts its voxels and rigs. Data "
      "goes to stdout, everything else to stderr.",
      "kelp-dump");
  app.set_version_flag("--version",
                       "kelp-dump " KELP_VERSION " (" KELP_BUILD ", extract: " + extractFormats() + ")");
  app.require_subcommand(1);
  app.footer(std::string(kExamples) + kExitCodes);
  std::vector<Command> commands;
  for (const auto add : {addInfo, addVerify, addDiff, addRig, addExtract, addSlice, addSchema})
    commands.push_back(add(app));

  // For a sub-command that does not exist, CLI11 only says that one is missing.
  const std::string first = words.size() > 1 ? words[1] : "";
  const auto isFirst = [&](const CLI::App* command) { return command->get_name() == first; };
  if (!first.empty() && first[0] != '-' && app.get_subcommands(isFirst).empty())
    throw ToolError(Exit::kUsage, nameText(first, 40) + ": is not a sub-command; " + kCommands);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));  // CLI11 takes the last first
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) failUsage(app, first, error);
    std::ostringstream text;  // --help, --version
    app.exit(error, text);
    print(text.str());
    return Exit::kOk;
  }
  for (const Command& command : commands) {
    if (!command.options->parsed()) continue;
    refuseEmptyValues(*command.options);
    return command.run();
  }
  throw ToolError(Exit::kUsage, std::string("no sub-command; ") + kCommands);
}

}  // namespace kelp::dump
